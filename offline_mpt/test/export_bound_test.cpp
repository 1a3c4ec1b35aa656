#include "export_bound.hpp"

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <set>

#include "compiled_code.hpp"
#include "exported_map.hpp"
#include "holds.hpp"
#include "map_export/export_map.hpp"
#include "refusal_of.hpp"
#include "synthetic_map.hpp"
#include "test_points.hpp"

namespace polyfly {
namespace {

/// Compiled code of floats, which is given numbers of the map.
class RoundingCode {
 public:
  RoundingCode(const ScratchFolder& folder, const RegionMap& map)
      : code_(folder, "code", "gcc -std=c99"), inputs_(map.inputs().size()) {}

  /// The parameters as the code is given them.
  static std::vector<float> rounded(const std::vector<double>& theta) { return {theta.begin(), theta.end()}; }

  int evaluate(const std::vector<double>& theta, std::vector<double>& u) const {
    std::vector<float> answer(inputs_, 0.0f);
    const int status = code_.evaluate(rounded(theta).data(), answer.data());
    u.assign(answer.begin(), answer.end());
    return status;
  }

  std::uint32_t region(const std::vector<double>& theta) const {
    std::uint32_t number = 0;
    EXPECT_EQ(code_.locate(rounded(theta).data(), &number), 0);
    return number;
  }

 private:
  CompiledCode<float> code_;
  std::size_t inputs_;
};

double greatestViolation(const RegionMap& map, std::uint32_t number, const std::vector<double>& theta) {
  const RegionView region = map.region(number);
  const std::size_t p = theta.size();
  long double greatest = 0.0L;
  for (std::uint32_t i = 0; i < region.row_count; ++i) {
    const double* const plane = map.plane(static_cast<std::size_t>(std::abs(region.rows[i])) - 1);
    long double distance = -static_cast<long double>(plane[p]);
    for (std::size_t k = 0; k < p; ++k) distance += static_cast<long double>(plane[k]) * theta[k];
    greatest = std::max(greatest, region.rows[i] < 0 ? -distance : distance);
  }
  return static_cast<double>(greatest);
}

class ExportBoundTest : public testing::Test {
 protected:
  ExportBoundTest()
      : made(kinkedMap()),
        map(checkedMap(made)),
        code(exportSource(made.map, floatOptions())),
        proven(checker::exportedAnswers(map, checker::readCode(code))),
        facts(exportFacts(made.map, floatOptions(), provenBound(proven, checker::readCode(code)))),
        header(exportHeader(made.map, floatOptions(), {proven.error, proven.margin, {}, {}})) {}

  std::string verdict(const std::string& changed) const {
    return refusalOf([&] { checker::confirmExport(facts, changed, header, map); });
  }

  const MadeMap made;
  const checker::Map map;
  const std::string code;
  const checker::ExportedAnswers proven;
  const std::string facts;
  const std::string header;
};

TEST_F(ExportBoundTest, IsOfTheOrderOfRounding) {
  EXPECT_TRUE(proven.missing.empty());
  EXPECT_GT(proven.error[0], 1e-7);
  EXPECT_LT(proven.error[0], 1e-4);
  EXPECT_GT(proven.margin, 0.0);
  EXPECT_LT(proven.margin, 1e-4);
  EXPECT_EQ(verdict(code), "");
}

// The compiled code against the law itself, which the map does not know in closed form.
TEST_F(ExportBoundTest, CompiledCodeStaysWithinIt) {
  if (!hasProgram("gcc")) GTEST_SKIP() << "no gcc";
  const ScratchFolder folder;
  saveText(folder.file("code.c"), code);
  saveText(folder.file("code.h"), header);
  const RoundingCode compiled(folder, made.map);
  TestPoints points(made.map, 9);
  double greatest = 0.0;
  int inside = 0;
  for (int i = 0; i < 100000; ++i) {
    const std::vector<double> theta = points.next();
    double expected = 0.0;
    const LookupStatus status = made.map.evaluate(theta.data(), &expected).status;
    std::vector<double> u;
    const int found = compiled.evaluate(theta, u);
    if (status == LookupStatus::kNotFinite) {
      ASSERT_EQ(found, 2) << i;
    }
    if (status != LookupStatus::kInside) continue;
    ++inside;
    ASSERT_EQ(found, 0) << i;
    const double law = std::abs(theta[0]) + std::abs(theta[1] - 0.5 * theta[0]);
    greatest = std::max(greatest, std::abs(u[0] - law));
  }
  EXPECT_GT(inside, 50000);
  EXPECT_LE(greatest, proven.error[0]);
  EXPECT_GT(greatest, 1e-3 * proven.error[0]);
}

// Every number of every table, changed by more than the bound forgives.
TEST_F(ExportBoundTest, ChangedTablesAreRefused) {
  struct Change {
    const char* table;
    double factor, step;
  };
  // About a hundredth of the greatest number.
  constexpr double kStep = 0.01;
  for (const Change& change : {Change{"_plane[", 1.0, kStep}, Change{"_law[", 1.0, kStep},
                               Change{"_box[", 0.5, 0.0}, Change{"_tolerance = ", 1000.0, 0.0},
                               Change{"_row[", 1.0, 1.0}, Change{"_candidate_region[", 0.0, 3.0},
                               Change{"_region_law[", 0.0, 3.0}, Change{"_node_child[", 0.0, 2.0},
                               Change{"_leaf_first[", 0.0, 1.0}, Change{"_candidate_first[", 0.0, 1.0}}) {
    int tried = 0;
    const std::size_t table = code.find(std::string(" code") + change.table);
    ASSERT_NE(table, std::string::npos) << change.table;
    const bool is_scalar = std::string(change.table).find('=') != std::string::npos;
    std::size_t place = code.find(is_scalar ? "= " : "= {", table) + 2;
    const std::size_t end = code.find(';', table);
    while ((place = code.find_first_of("-0123456789", place)) < end) {
      char* rest = nullptr;
      const double value = std::strtod(code.c_str() + place, &rest);
      const std::size_t length = static_cast<std::size_t>(rest - code.c_str()) - place;
      const bool is_real = *rest == 'f';
      const double other = value * change.factor + change.step;
      if (other != value) {
        const std::string digits = is_real ? std::to_string(other) : std::to_string(static_cast<long>(other));
        std::string text = code;
        EXPECT_NE(verdict(text.replace(place, length, digits)), "") << change.table << " " << value;
        ++tried;
      }
      place += length + 1;
    }
    EXPECT_GT(tried, 0) << change.table;
  }
}

TEST_F(ExportBoundTest, AStatedBoundBelowTheProvenOneIsRefused) {
  const ExportBound less = {{0.9 * proven.error[0]}, proven.margin, {}, {}};
  const std::string claims = exportFacts(made.map, floatOptions(), less);
  EXPECT_TRUE(holds(refusalOf([&] { checker::confirmExport(claims, code, header, map); }), "input 0"));
  const ExportBound narrow = {proven.error, 0.9 * proven.margin, {}, {}};
  const std::string others = exportFacts(made.map, floatOptions(), narrow);
  EXPECT_TRUE(holds(refusalOf([&] { checker::confirmExport(others, code, header, map); }), "margin"));
}

// Earlier versions took the candidate with the least violation, which is another look-up.
TEST_F(ExportBoundTest, CodeThatSearchesInAnotherWayIsRefused) {
  std::string text = code;
  const std::string present = "code_holds(", former = "code_violation(";
  for (std::size_t at = text.find(present); at != std::string::npos; at = text.find(present))
    text.replace(at, present.size(), former);
  EXPECT_NE(verdict(text), "");
}

TEST_F(ExportBoundTest, CodeOfAnotherMapIsRefused) {
  MapContent content = kinkedMap();
  content.laws[0] += 1e-3;
  const MadeMap other(content);
  EXPECT_NE(refusalOf([&] { checker::confirmExport(facts, code, header, checkedMap(other)); }), "");
}

// Doubles have the map's tables and answers; a change of the last bit is refused.
TEST(ExportBoundOfDoubles, AreComparedNumberForNumber) {
  const MadeMap made(kinkedMap());
  const checker::Map map = checkedMap(made);
  const ExportOptions options = optionsOf(ExportType::kDouble);
  const std::string source = exportSource(made.map, options);
  EXPECT_EQ(checker::exportedAnswers(map, checker::readCode(source)).error, std::vector<double>{0.0});
  MapContent content = kinkedMap();
  content.planes[0] = std::nextafter(content.planes[0], 1.0);
  const std::string changed = exportSource(MadeMap(content).map, options);
  EXPECT_NE(refusalOf([&] { checker::exportedAnswers(map, checker::readCode(changed)); }), "");
}

// Maps with jumps between regions and with holes: what is proven holds for the compiled code.
TEST(ExportBoundOfRandomMaps, HoldsForCompiledCode) {
  if (!hasProgram("gcc")) GTEST_SKIP() << "no gcc";
  for (std::uint32_t p = 1; p <= 4; ++p) {
    TreeRecipe recipe;
    recipe.parameters = p;
    recipe.inputs = 1 + p % 2;
    recipe.regions = 20;
    recipe.leaf_regions = 3;
    recipe.holes_one_in = 4;
    recipe.seed = p;
    const MadeMap made(makeTreeMap(recipe));
    const checker::Map map = checkedMap(made);
    ExportOptions options = floatOptions();
    checker::ExportedAnswers proven =
        checker::exportedAnswers(map, checker::readCode(exportSource(made.map, options)));
    for (const auto& [leaf, region] : proven.missing) options.chosen.push_back({leaf, region});
    const std::string source = exportSource(made.map, options);
    proven = checker::exportedAnswers(map, checker::readCode(source));
    ASSERT_TRUE(proven.missing.empty()) << p;
    const ScratchFolder folder;
    saveText(folder.file("code.c"), source);
    saveText(folder.file("code.h"), exportHeader(made.map, options, {proven.error, proven.margin, {}, {}}));
    const RoundingCode compiled(folder, made.map);
    TestPoints points(made.map, p);
    for (int i = 0; i < 20000; ++i) {
      const std::vector<double> theta = points.next();
      std::vector<double> expected(recipe.inputs, 0.0), u;
      const LookupStatus status = made.map.evaluate(theta.data(), expected.data()).status;
      if (status == LookupStatus::kNotFinite) continue;
      const int found = compiled.evaluate(theta, u);
      if (found == 0) {
        const std::vector<float> given = RoundingCode::rounded(theta);
        ASSERT_LE(greatestViolation(made.map, compiled.region(theta), {given.begin(), given.end()}),
                  proven.margin)
            << p << " " << i;
      }
      if (status != LookupStatus::kInside) continue;
      ASSERT_EQ(found, 0) << p << " " << i;
      for (std::size_t j = 0; j < u.size(); ++j)
        ASSERT_LE(std::abs(u[j] - expected[j]), proven.error[j]) << p << " " << i;
    }
  }
}

}  // namespace
}  // namespace polyfly
