#include "lookup_work.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "compiled_code.hpp"
#include "exported_map.hpp"
#include "test_points.hpp"

namespace polyfly {
namespace {

/// The look-up as region_maps/region_maps/export/README.md describes it, on the tables of the code, for one parameter. `value` is
/// the value of a row there.
template <class Theta, class Value>
checker::LookupWork countedWork(const checker::LookupTables& code, const Theta& theta, const Value& value) {
  checker::LookupWork work = {0, 2 * code.p};
  std::uint32_t child = code.root();
  while (child < code.node_plane.size()) {
    ++work.sums;
    ++work.comparisons;
    child = code.children[child][value(2 * code.node_plane[child], theta) <= 0.0 ? 0 : 1];
  }
  double least = 1e9;
  bool has_answer = false;
  for (const auto& candidate : code.leaves[child - code.node_plane.size()]) {
    double greatest = -1e9;
    for (const std::uint32_t row : candidate.rows) {
      const double violation = value(row, theta);
      ++work.sums;
      work.comparisons += code.takes_first ? 1 : 2;
      greatest = std::max(greatest, violation);
      if (violation > code.tolerance) {
        greatest = 1e9;
        break;
      }
    }
    has_answer = has_answer || greatest < 1e9;
    work.comparisons += code.takes_first ? 1 : 4;
    if (code.takes_first && has_answer) break;
    if (candidate.is_fallback) greatest = std::max(greatest, 0.0) + code.handicap;
    least = std::min(least, greatest);
    if (least <= 0.0) break;
  }
  if (has_answer) work.sums += code.q;
  return work;
}

checker::LookupWork countedWork(const checker::LookupTables& code, const std::vector<double>& theta) {
  return countedWork(code, theta, [&](std::uint32_t row, const std::vector<double>& at) {
    const double* const plane = code.planes.data() + (row >> 1) * (code.p + 1);
    double sum = -plane[code.p];
    for (std::size_t k = 0; k < code.p; ++k) sum += plane[k] * at[k];
    return (row & 1u) != 0 ? -sum : sum;
  });
}

MapContent mapOfHoles(std::uint32_t parameters, std::uint64_t seed) {
  TreeRecipe recipe;
  recipe.parameters = parameters;
  recipe.regions = 24;
  recipe.leaf_regions = 5;
  recipe.holes_one_in = 3;
  recipe.seed = seed;
  MapContent content = makeTreeMap(recipe);
  content.first_fallback = static_cast<std::uint32_t>(content.regions.size() - 4);
  return content;
}

checker::LookupWork provenWork(const checker::ExportedCode& code) {
  const checker::ProofWatch watch;
  return checker::WorkProof(code, watch).run();
}

/// Of one parameter: floats around all places where a row or the box changes its outcome, and one between any two.
std::vector<double> distinctParameters(const checker::LookupTables& code) {
  constexpr int kNeighbours = 64;
  std::vector<double> places = {code.box.lower[0], code.box.upper[0]};
  for (std::size_t k = 0; k < code.planes.size(); k += 2) {
    for (const double shift : {-code.tolerance, 0.0, code.tolerance})
      places.push_back((code.planes[k + 1] + shift) / code.planes[k]);
  }
  std::sort(places.begin(), places.end());
  std::vector<double> result;
  const auto add = [&](float number) {
    if (number >= code.box.lower[0] && number <= code.box.upper[0]) result.push_back(number);
  };
  for (std::size_t k = 0; k < places.size(); ++k) {
    auto below = static_cast<float>(places[k]), above = below;
    for (int i = 0; i < kNeighbours; ++i) {
      add(below = std::nextafter(below, -HUGE_VALF));
      add(above = std::nextafter(above, HUGE_VALF));
    }
    add(static_cast<float>(places[k]));
    if (k > 0) add(static_cast<float>(0.5 * (places[k - 1] + places[k])));
  }
  return result;
}

/// In the arithmetic of floats.
checker::LookupWork countedFloatWork(const checker::LookupTables& code, double parameter) {
  return countedWork(code, static_cast<float>(parameter), [&](std::uint32_t row, float theta) {
    const double* const plane = code.planes.data() + (row >> 1) * 2;
    const float product = static_cast<float>(plane[0]) * theta;
    const float sum = product - static_cast<float>(plane[1]);
    return static_cast<double>((row & 1u) != 0 ? -sum : sum);
  });
}

// With one parameter, all look-ups that there are.
TEST(LookupWork, IsTheGreatestOfAllLookups) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const MadeMap made(mapOfHoles(1, seed));
    const checker::ExportedCode code =
        checker::readCode(exportSource(made.map, optionsOf(ExportType::kFloat)));
    checker::LookupWork greatest;
    for (const double theta : distinctParameters(code.tables))
      greatest = checker::greater(greatest, countedFloatWork(code.tables, theta));
    const checker::LookupWork proven = provenWork(code);
    EXPECT_EQ(proven.sums, greatest.sums) << seed;
    EXPECT_EQ(proven.comparisons, greatest.comparisons) << seed;
  }
}

TEST(LookupWork, IsExceededByNoRandomLookup) {
  for (const ExportType type : {ExportType::kDouble, ExportType::kFloat}) {
    for (std::uint32_t p = 2; p <= 4; ++p) {
      const MadeMap made(mapOfHoles(p, p));
      const checker::ExportedCode code = checker::readCode(exportSource(made.map, optionsOf(type)));
      const checker::LookupWork proven = provenWork(code);
      TestPoints points(made.map, p);
      std::uint64_t greatest = 0;
      for (int i = 0; i < 20000; ++i) {
        std::vector<double> theta = points.next();
        bool is_inside = true;
        for (std::size_t k = 0; k < p; ++k) {
          if (type == ExportType::kFloat) theta[k] = static_cast<float>(theta[k]);
          is_inside =
              is_inside && theta[k] >= code.tables.box.lower[k] && theta[k] <= code.tables.box.upper[k];
        }
        if (!is_inside) continue;
        const checker::LookupWork work = countedWork(code.tables, theta);
        ASSERT_LE(work.sums, proven.sums);
        ASSERT_LE(work.comparisons, proven.comparisons);
        greatest = std::max(greatest, work.sums);
      }
      EXPECT_GE(4 * greatest, 3 * proven.sums);
    }
  }
}

/// The value of a row in float, in the order of the code: a x - c, (a x + b y) - c, or (a x + b y) + (d z - c).
float floatValue(const checker::LookupTables& code, std::uint32_t row, const std::vector<float>& theta) {
  std::vector<float> plane;
  for (std::size_t k = 0; k <= code.p; ++k)
    plane.push_back(static_cast<float>(code.planes[(row >> 1) * (code.p + 1) + k]));
  const float product = plane[0] * theta[0];
  const float first = code.p == 1 ? product : product + plane[1] * theta[1];
  const float value = code.p == 3 ? first + (plane[2] * theta[2] - plane[3]) : first - plane[code.p];
  return (row & 1u) != 0 ? -value : value;
}

/// Planes of nearly the same directions through a box of few floats, so that rounding decides which paths are taken. With
/// one parameter all sums are exact: values are some of the multiples of the floats' distance, down to a single one.
checker::ExportedCode thinCode(std::size_t p, std::size_t numbers, bool beside_power, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const auto uniform = [&](double size) {
    return size * (2.0 * static_cast<double>(random() >> 11) * 0x1p-53 - 1.0);
  };
  checker::ExportedCode code;
  code.type = checker::CodeType::kFloat;
  checker::LookupTables& tables = code.tables;
  tables.p = p;
  tables.q = 1;
  tables.takes_first = true;
  tables.tolerance = static_cast<float>(1e-7);
  std::vector<double> centre;
  for (std::size_t k = 0; k < p; ++k) {
    float lower = static_cast<float>(0.75 + uniform(0.2));
    // From there on the distance of floats doubles.
    if (beside_power && k == 0) lower = 1.0f - 0x1p-24f * static_cast<float>(numbers / 2);
    float upper = lower;
    for (std::size_t i = 1; i < numbers; ++i) upper = std::nextafter(upper, 2.0f);
    tables.box.lower.push_back(lower);
    tables.box.upper.push_back(upper);
    centre.push_back(0.5 * (lower + upper));
  }
  constexpr std::uint32_t kPlanes = 16;
  for (std::uint32_t i = 0; i < kPlanes; ++i) {
    double constant = uniform(1.5e-7);
    for (std::size_t k = 0; k < p; ++k) {
      tables.planes.push_back(static_cast<float>(p == 1 ? 0.5 : (k == 1 ? -0.6 : 0.5) + uniform(0.02)));
      constant += tables.planes.back() * centre[k];
    }
    tables.planes.push_back(static_cast<float>(constant));
  }
  const auto row = [&] { return static_cast<std::uint32_t>(random() % (2 * kPlanes)); };
  for (std::uint32_t i = 0; i < 3; ++i) {
    tables.node_plane.push_back(row() / 2);
    tables.children.push_back({2 * i + 1, 2 * i + 2});
  }
  for (std::uint32_t i = 0; i < 4; ++i) {
    tables.leaves.emplace_back();
    for (int candidate = 0; candidate < 3; ++candidate) {
      tables.leaves.back().emplace_back();
      for (int k = 0; k < 4; ++k) tables.leaves.back().back().rows.push_back(row());
    }
  }
  tables.laws.assign(p + 1, 0.0);
  checker::boundRounding(tables, checker::kFloats);
  return code;
}

// With so few floats, all look-ups that there are.
TEST(LookupWork, IsTheGreatestOfAllLookupsOfFewFloats) {
  for (std::uint64_t seed = 1; seed <= 90; ++seed) {
    const std::size_t p = 1 + seed % 3, numbers = p == 3 ? 14 : 64;
    const checker::ExportedCode code = thinCode(p, numbers, seed % 4 == 0, seed);
    const auto valueOf = [&](std::uint32_t row, const std::vector<float>& theta) {
      return floatValue(code.tables, row, theta);
    };
    checker::LookupWork greatest;
    std::vector<std::size_t> at(p, 0);
    const std::vector<float> first(code.tables.box.lower.begin(), code.tables.box.lower.end());
    std::vector<float> theta = first;
    for (std::size_t k = 0; k < p;) {
      const checker::LookupWork work = countedWork(code.tables, theta, valueOf);
      greatest = checker::greater(greatest, work);
      for (k = 0; k < p; ++k) {
        theta[k] = std::nextafter(theta[k], 2.0f);
        if (++at[k] < numbers) break;
        theta[k] = first[k];
        at[k] = 0;
      }
    }
    const checker::LookupWork proven = provenWork(code);
    EXPECT_EQ(proven.sums, greatest.sums) << seed;
    EXPECT_EQ(proven.comparisons, greatest.comparisons) << seed;
  }
}

/// Counts what the compiled look-up reads of its tables of numbers at each vector of code_test.c, and prints the most.
const char* const kCountedReads = R"(#include <stdio.h>
static unsigned long reads, most;
#define CODE_TABLE
#define CODE_U8(element) (element)
#define CODE_U16(element) (element)
#define CODE_U32(element) (element)
#define CODE_REAL(element) (++reads, (element))
#define CODE_I16(element) (++reads, (element))
#define CODE_TEST_NO_MAIN
#define CODE_TEST_BEGIN() reads = 0
#define CODE_TEST_END() most = reads > most ? reads : most
#include "code.c"
#include "code_test.c"
int main(void)
{
    (void)code_test();
    printf("%lu", most);
    return 0;
}
)";

class LookupWorkOfTypes : public testing::TestWithParam<ExportType> {};

// A sum reads p + 1 numbers, and the box has two for each parameter.
TEST_P(LookupWorkOfTypes, IsReachedByAVectorOfTheCodesTest) {
  if (!hasProgram("gcc")) GTEST_SKIP() << "no gcc";
  std::vector<MapContent> contents = {kinkedMap(), clippedMap()};
  for (std::uint32_t p = 1; p <= 4; ++p) contents.push_back(mapOfHoles(p, 10 + p));
  for (std::size_t i = 0; i < contents.size(); ++i) {
    const MadeMap made(contents[i]);
    const ExportOptions options = optionsOf(GetParam());
    const std::string source = exportSource(made.map, options);
    const checker::ExportedCode code = checker::readCode(source);
    const checker::ProofWatch watch;
    checker::WorkProof proof(code, watch);
    const checker::LookupWork proven = proof.run();
    // The answers themselves are not what this test is about.
    ExportBound bound = {std::vector<double>(code.tables.q, 0.0), 1e-3, {}, {}};
    for (const std::vector<double>& theta : proof.reached()) bound.costly.push_back({theta, {}});
    const ScratchFolder folder;
    saveText(folder, "code.c", source);
    saveText(folder, "code.h", exportHeader(made.map, options, bound));
    saveText(folder, "code_test.c", exportTest(made.map, options, bound));
    saveText(folder, "reads.c", kCountedReads);
    EXPECT_EQ(runCommand(folder, "gcc -std=c99 -O1 -ffp-contract=off reads.c -o reads && ./reads"), 0)
        << logOf(folder);
    const std::size_t p = code.tables.p;
    EXPECT_EQ(logOf(folder), std::to_string(2 * p + proven.sums * (p + 1))) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Types, LookupWorkOfTypes, testing::Values(ExportType::kDouble, ExportType::kFloat));

TEST(LookupWork, FactsThatStateLessAreRefused) {
  const MadeMap made(clippedMap());
  const checker::Map map = checkedMap(made);
  const std::string code = exportSource(made.map, floatOptions());
  const checker::ExportedAnswers answers = checker::exportedAnswers(map, checker::readCode(code));
  const checker::LookupWork work = provenWork(checker::readCode(code));
  const auto verdict = [&](const LookupWork& stated) {
    const ExportBound bound = {answers.error, answers.margin, stated, {}};
    const std::string facts = exportFacts(made.map, floatOptions(), bound);
    const std::string header = exportHeader(made.map, floatOptions(), bound);
    return refusal([&] { checker::confirmExport(facts, code, header, map); });
  };
  EXPECT_EQ(verdict({work.sums, work.comparisons}), "confirmed");
  EXPECT_NE(verdict({work.sums - 1, work.comparisons}).find("multiply_adds"), std::string::npos);
  EXPECT_NE(verdict({work.sums, work.comparisons - 1}).find("comparisons"), std::string::npos);
}

}  // namespace
}  // namespace polyfly
