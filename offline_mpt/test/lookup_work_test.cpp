#include "lookup_work.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "compiled_code.hpp"
#include "exported_map.hpp"
#include "test_points.hpp"

namespace polyfly {
namespace {

/// The look-up as region_maps/export/README.md describes it, on the tables of the code, for one parameter of integers.
struct CountedLookup {
  const checker::LookupTables& code;
  checker::LookupWork work;

  double value(std::uint32_t row, const std::vector<double>& theta) {
    ++work.sums;
    const double* const plane = code.planes.data() + (row >> 1) * (code.p + 1);
    double sum = -plane[code.p];
    for (std::size_t k = 0; k < code.p; ++k) sum += plane[k] * theta[k];
    return (row & 1u) != 0 ? -sum : sum;
  }

  void run(const std::vector<double>& theta) {
    work = {0, 2 * code.p};
    std::uint32_t child = code.root();
    while (child < code.node_plane.size()) {
      ++work.comparisons;
      child = code.children[child][value(2 * code.node_plane[child], theta) <= 0.0 ? 0 : 1];
    }
    double least = 1e9;
    bool has_answer = false;
    for (const auto& candidate : code.leaves[child - code.node_plane.size()]) {
      double greatest = -1e9;
      for (const std::uint32_t row : candidate.rows) {
        const double violation = value(row, theta);
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
  }
};

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

// With one parameter of 16 bits, all look-ups that there are.
TEST(LookupWork, IsTheGreatestOfAllLookups) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const MadeMap made(mapOfHoles(1, seed));
    const checker::ExportedCode code =
        checker::readCode(exportSource(made.map, optionsOf(ExportType::kInt16)));
    const double unit = std::ldexp(1.0, -exportExponents(made.map, optionsOf(ExportType::kInt16)).theta[0]);
    CountedLookup lookup{code.tables, {}};
    checker::LookupWork greatest;
    for (double theta = code.tables.box.lower[0]; theta <= code.tables.box.upper[0]; theta += unit) {
      lookup.run({theta});
      greatest.sums = std::max(greatest.sums, lookup.work.sums);
      greatest.comparisons = std::max(greatest.comparisons, lookup.work.comparisons);
    }
    const checker::LookupWork proven = provenWork(code);
    EXPECT_EQ(proven.sums, greatest.sums) << seed;
    EXPECT_EQ(proven.comparisons, greatest.comparisons) << seed;
  }
}

TEST(LookupWork, IsExceededByNoRandomLookup) {
  for (const ExportType type : {ExportType::kDouble, ExportType::kFloat, ExportType::kInt16}) {
    for (std::uint32_t p = 2; p <= 4; ++p) {
      const MadeMap made(mapOfHoles(p, p));
      const checker::ExportedCode code = checker::readCode(exportSource(made.map, optionsOf(type)));
      const checker::LookupWork proven = provenWork(code);
      const ExportExponents exponents = exportExponents(made.map, optionsOf(type));
      CountedLookup lookup{code.tables, {}};
      TestPoints points(made.map, p);
      std::uint64_t greatest = 0;
      for (int i = 0; i < 20000; ++i) {
        std::vector<double> theta = points.next();
        bool is_inside = true;
        for (std::size_t k = 0; k < p; ++k) {
          if (!exponents.theta.empty())
            theta[k] =
                std::ldexp(std::nearbyint(std::ldexp(theta[k], exponents.theta[k])), -exponents.theta[k]);
          is_inside =
              is_inside && theta[k] >= code.tables.box.lower[k] && theta[k] <= code.tables.box.upper[k];
        }
        if (!is_inside) continue;
        lookup.run(theta);
        ASSERT_LE(lookup.work.sums, proven.sums);
        ASSERT_LE(lookup.work.comparisons, proven.comparisons);
        greatest = std::max(greatest, lookup.work.sums);
      }
      EXPECT_GE(4 * greatest, 3 * proven.sums);
    }
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

INSTANTIATE_TEST_SUITE_P(Types, LookupWorkOfTypes,
                         testing::Values(ExportType::kDouble, ExportType::kFloat, ExportType::kInt16));

TEST(LookupWork, FactsThatStateLessAreRefused) {
  const MadeMap made(clippedMap());
  const checker::Map map = checkedMap(made);
  const std::string code = exportSource(made.map, floatOptions());
  const checker::ExportedAnswers answers = checker::exportedAnswers(map, checker::readCode(code));
  const checker::LookupWork work = provenWork(checker::readCode(code));
  const auto verdict = [&](const LookupWork& stated) {
    const ExportBound bound = {answers.error, answers.margin, stated, {}};
    const std::string facts = exportFacts(made.map, floatOptions(), bound);
    return refusal([&] { checker::confirmExport(facts, code, map); });
  };
  EXPECT_EQ(verdict({work.sums, work.comparisons}), "confirmed");
  EXPECT_NE(verdict({work.sums - 1, work.comparisons}).find("multiply_adds"), std::string::npos);
  EXPECT_NE(verdict({work.sums, work.comparisons - 1}).find("comparisons"), std::string::npos);
}

}  // namespace
}  // namespace polyfly
