#include "lookup_work.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "compiled_code.hpp"
#include "exported_map.hpp"
#include "holds.hpp"
#include "refusal_of.hpp"
#include "test_points.hpp"

namespace polyfly {
namespace {

/// The look-up as region_maps/region_maps/export/README.md describes it, on the tables of the code, for one parameter.
checker::LookupWork countedWork(const checker::LookupTables& code, const std::vector<double>& theta) {
  const auto value = [&](std::uint32_t row) {
    const double* const plane = code.planes.data() + (row >> 1) * (code.p + 1);
    double sum = -plane[code.p];
    for (std::size_t k = 0; k < code.p; ++k) sum += plane[k] * theta[k];
    return (row & 1u) != 0 ? -sum : sum;
  };
  checker::LookupWork work = {0, 2 * code.p};
  std::uint32_t child = code.root();
  while (child < code.node_plane.size()) {
    ++work.sums;
    ++work.comparisons;
    child = code.children[child][value(2 * code.node_plane[child]) <= 0.0 ? 0 : 1];
  }
  double least = 1e9;
  bool has_answer = false;
  for (const auto& candidate : code.leaves[child - code.node_plane.size()]) {
    double greatest = -1e9;
    for (const std::uint32_t row : candidate.rows) {
      const double violation = value(row);
      ++work.sums;
      work.comparisons += code.takes_first ? 1 : 2;
      greatest = std::max(greatest, violation);
      if (violation > code.tolerance) {
        greatest = 1e9;
        break;
      }
    }
    has_answer = has_answer || greatest < 1e9;
    work.comparisons += code.takes_first ? 1 : 2;
    if (code.takes_first && has_answer) break;
    least = std::min(least, greatest);
    if (least <= 0.0) break;
  }
  if (has_answer) work.sums += code.q;
  return work;
}

MapContent mapOfHoles(std::uint32_t parameters, std::uint64_t seed) {
  TreeRecipe recipe;
  recipe.parameters = parameters;
  recipe.regions = 24;
  recipe.leaf_regions = 5;
  recipe.holes_one_in = 3;
  recipe.seed = seed;
  return makeTreeMap(recipe);
}

// One node, then a leaf whose candidates have 6 and 5 rows, and the law.
TEST(LookupWork, IsThatOfTheWorstLeaf) {
  const MadeMap made(clippedMap());
  const checker::LookupWork work =
      checker::greatestWork(checker::readCode(exportSource(made.map, optionsOf(ExportType::kDouble))).tables);
  EXPECT_EQ(work.sums, 1u + 6 + 5 + 1);
  EXPECT_EQ(work.comparisons, 2u * 2 + 1 + 2 * (6 + 5) + 2 * 2);
}

TEST(LookupWork, IsExceededByNoRandomLookup) {
  for (const ExportType type : {ExportType::kDouble, ExportType::kFloat}) {
    for (std::uint32_t p = 2; p <= 4; ++p) {
      const MadeMap made(mapOfHoles(p, p));
      const checker::ExportedCode code = checker::readCode(exportSource(made.map, optionsOf(type)));
      const checker::LookupWork proven = checker::greatestWork(code.tables);
      TestPoints points(made.map, p);
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
      }
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
TEST_P(LookupWorkOfTypes, IsExceededByNoVectorOfTheCodesTest) {
  if (!hasProgram("gcc")) GTEST_SKIP() << "no gcc";
  std::vector<MapContent> contents = {kinkedMap(), clippedMap()};
  for (std::uint32_t p = 1; p <= 4; ++p) contents.push_back(mapOfHoles(p, 10 + p));
  for (std::size_t i = 0; i < contents.size(); ++i) {
    const MadeMap made(contents[i]);
    const ExportOptions options = optionsOf(GetParam());
    const std::string source = exportSource(made.map, options);
    const checker::ExportedCode code = checker::readCode(source);
    const checker::LookupWork proven = checker::greatestWork(code.tables);
    // The answers themselves are not what this test is about.
    const ExportBound bound = {std::vector<double>(code.tables.q, 0.0), 1e-3, {}, {}};
    const ScratchFolder folder;
    saveText(folder.file("code.c"), source);
    saveText(folder.file("code.h"), exportHeader(made.map, options, bound));
    saveText(folder.file("code_test.c"), exportTest(made.map, options, bound));
    saveText(folder.file("reads.c"), kCountedReads);
    EXPECT_EQ(runCommand(folder, "gcc -std=c99 -O1 -ffp-contract=off reads.c -o reads && ./reads"), 0)
        << logOf(folder);
    const std::size_t p = code.tables.p;
    const std::uint64_t reads = std::stoull(logOf(folder)), most = 2 * p + proven.sums * (p + 1);
    EXPECT_LE(reads, most) << i;
    EXPECT_GE(3 * reads, most) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Types, LookupWorkOfTypes, testing::Values(ExportType::kDouble, ExportType::kFloat));

TEST(LookupWork, FactsThatStateLessAreRefused) {
  const MadeMap made(clippedMap());
  const checker::Map map = checkedMap(made);
  const std::string code = exportSource(made.map, floatOptions());
  const checker::ExportedAnswers answers = checker::exportedAnswers(map, checker::readCode(code));
  const checker::LookupWork work = checker::greatestWork(checker::readCode(code).tables);
  const auto verdict = [&](const LookupWork& stated) {
    const ExportBound bound = {answers.error, answers.margin, stated, {}};
    const std::string facts = exportFacts(made.map, floatOptions(), bound);
    const std::string header = exportHeader(made.map, floatOptions(), bound);
    return refusalOf([&] { checker::confirmExport(facts, code, header, map); });
  };
  EXPECT_EQ(verdict({work.sums, work.comparisons}), "");
  EXPECT_TRUE(holds(verdict({work.sums - 1, work.comparisons}), "multiply_adds"));
  EXPECT_TRUE(holds(verdict({work.sums, work.comparisons - 1}), "comparisons"));
}

}  // namespace
}  // namespace polyfly
