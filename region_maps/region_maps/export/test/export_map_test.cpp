#include "map_export/export_map.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "compiled_code.hpp"
#include "error_of.hpp"
#include "test_points.hpp"

namespace polyfly {
namespace {

constexpr int kOk = 0;
constexpr int kOutside = 1;
constexpr int kNotFinite = 2;

int statusOf(LookupStatus status) {
  switch (status) {
    case LookupStatus::kInside:
      return kOk;
    case LookupStatus::kOutsideBox:
    case LookupStatus::kOutsidePartition:
      return kOutside;
    case LookupStatus::kNotFinite:
      return kNotFinite;
  }
  return -1;
}

ExportOptions codeOptions() {
  ExportOptions options;
  options.name = "code";
  return options;
}

ExportBound noError(const RegionMap& map) {
  return {std::vector<double>(map.inputs().size(), 0.0), 0.0, {}, {}};
}

void saveCode(const ScratchFolder& folder, const RegionMap& map, const ExportOptions& options) {
  saveText(folder.file(options.name + ".c"), exportSource(map, options));
  saveText(folder.file(options.name + ".h"), exportHeader(map, options, noError(map)));
  saveText(folder.file(options.name + "_test.c"), exportTest(map, options, noError(map)));
}

/// Status, region, and each bit of u.
void expectSameAnswers(const RegionMap& map, const std::string& compiler, int points) {
  const ScratchFolder folder;
  saveCode(folder, map, codeOptions());
  const CompiledCode<double> code(folder, "code", compiler);
  TestPoints source(map, 5);
  std::vector<int> seen(3, 0);
  for (int i = 0; i < points; ++i) {
    const std::vector<double> theta = source.next();
    std::vector<double> expected(map.inputs().size(), 99.0);
    std::vector<double> u = expected;
    const Lookup found = map.evaluate(theta.data(), expected.data());
    std::uint32_t region = 0xffffffffu;
    ASSERT_EQ(code.evaluate(theta.data(), u.data()), statusOf(found.status)) << i;
    ASSERT_EQ(std::memcmp(u.data(), expected.data(), u.size() * sizeof u[0]), 0) << i;
    ASSERT_EQ(code.locate(theta.data(), &region), statusOf(found.status)) << i;
    ASSERT_EQ(region, found.status == LookupStatus::kInside ? found.region : 0xffffffffu) << i;
    ++seen[static_cast<std::size_t>(statusOf(found.status))];
  }
  for (const int count : seen) EXPECT_GT(count, points / 100);
}

class ExportMap : public testing::TestWithParam<std::uint32_t> {
 protected:
  static MapContent content(std::uint32_t p) {
    TreeRecipe recipe;
    recipe.parameters = p;
    recipe.inputs = 1 + p % 3;
    recipe.regions = 60;
    recipe.leaf_regions = 1 + 2 * (p % 3);
    recipe.holes_one_in = 3;
    recipe.names_tests = p % 2 == 0;
    recipe.seed = 40 + p;
    return makeTreeMap(recipe);
  }
};

TEST_P(ExportMap, AnswersAsTheMapBitForBit) {
  if (!hasProgram("gcc")) GTEST_SKIP() << "no gcc";
  expectSameAnswers(MadeMap(content(GetParam())).map, "gcc -std=c99", 20000);
}

// Nine parameters are added in a loop, the others by halves.
INSTANTIATE_TEST_SUITE_P(Parameters, ExportMap, testing::Values(1u, 2u, 3u, 4u, 5u, 7u, 8u, 9u));

TEST(ExportMapCompilers, AllGiveTheSameAnswers) {
  TreeRecipe recipe;
  recipe.parameters = 4;
  recipe.holes_one_in = 4;
  recipe.leaf_regions = 4;
  const MadeMap made(makeTreeMap(recipe));
  int tried = 0;
  for (const char* const compiler :
       {"clang -std=c99", "g++ -x c++ -std=c++17", "clang++ -x c++ -std=c++11", "gcc -std=c11"}) {
    if (!hasProgram(std::string(compiler).substr(0, std::string(compiler).find(' ')))) continue;
    expectSameAnswers(made.map, compiler, 5000);
    ++tried;
  }
  if (tried < 4) GTEST_SKIP() << "only " << tried << " of 4 compilers are installed";
}

TEST(ExportMapShapes, AMapWithoutNodesAndOneWithEmptyLeavesCompile) {
  if (!hasProgram("gcc")) GTEST_SKIP() << "no gcc";
  TreeRecipe whole;
  whole.regions = 1;
  MapContent single = makeTreeMap(whole);
  ASSERT_TRUE(single.nodes.empty());
  expectSameAnswers(MadeMap(single).map, "gcc -std=c99", 200);
  single.leaves = {{0, 0}};
  single.candidates.clear();
  single.tests.clear();
  const MadeMap empty(single);
  const ScratchFolder folder;
  saveCode(folder, empty.map, codeOptions());
  const CompiledCode<double> code(folder, "code", "gcc -std=c99");
  const std::vector<double> theta = TestPoints(empty.map, 1).next();
  double u[3] = {};
  EXPECT_EQ(code.evaluate(theta.data(), u), kOutside);
}

TEST(ExportMapTest, ItsOwnTestPassesAndSeesAChangedLaw) {
  if (!hasProgram("gcc")) GTEST_SKIP() << "no gcc";
  TreeRecipe recipe;
  recipe.laws = 3;
  MapContent content = makeTreeMap(recipe);
  const MadeMap made(content);
  const ScratchFolder folder;
  saveCode(folder, made.map, codeOptions());
  const std::string build = std::string("gcc -std=c99 ") + kStrict + "code.c code_test.c -o code && ./code";
  EXPECT_EQ(runCommand(folder, build), 0) << logOf(folder);
  content.laws[1] += 1e-12;
  saveText(folder.file("code.c"), exportSource(MadeMap(content).map, codeOptions()));
  EXPECT_GT(runCommand(folder, build), 0);
}

TEST(ExportMapSafety, FastMathDoesNotCompile) {
  if (!hasProgram("gcc")) GTEST_SKIP() << "no gcc";
  const MadeMap made(makeSmallMap());
  const ScratchFolder folder;
  saveCode(folder, made.map, codeOptions());
  for (const char* const option : {"-Ofast", "-ffast-math", "-ffinite-math-only"}) {
    EXPECT_NE(runCommand(folder, std::string("gcc -std=c99 -c code.c ") + option), 0) << option;
    EXPECT_NE(logOf(folder).find("#error"), std::string::npos) << option;
  }
}

// The constants of the tables would be floats, which a look-up of doubles shows nowhere.
TEST(ExportMapSafety, SinglePrecisionConstantsDoNotCompile) {
  if (!hasProgram("gcc")) GTEST_SKIP() << "no gcc";
  const MadeMap made(makeSmallMap());
  const ScratchFolder folder;
  saveCode(folder, made.map, codeOptions());
  for (const char* const compiler : {"gcc -std=c99", "gcc -std=c11", "g++ -x c++ -std=c++17"}) {
    EXPECT_EQ(runCommand(folder, std::string(compiler) + " -c code.c"), 0) << logOf(folder);
    EXPECT_NE(runCommand(folder, std::string(compiler) + " -c code.c -fsingle-precision-constant"), 0)
        << compiler;
    EXPECT_NE(logOf(folder).find("code_constants"), std::string::npos) << logOf(folder);
  }
}

// It has no macro in clang, and GCC refuses it.
TEST(ExportMapSafety, UnsafeMathOfClangChangesNoInstruction) {
  if (!hasProgram("clang")) GTEST_SKIP() << "no clang";
  TreeRecipe recipe;
  recipe.parameters = 5;
  const MadeMap made(makeTreeMap(recipe));
  const ScratchFolder folder;
  saveCode(folder, made.map, codeOptions());
  EXPECT_EQ(runCommand(folder,
                       "clang -std=c99 -O2 -c code.c -o safe.o && clang -std=c99 -O2 "
                       "-funsafe-math-optimizations -c code.c -o unsafe.o && cmp safe.o unsafe.o"),
            0)
      << logOf(folder);
}

TEST(ExportMapSafety, CodeHasNoWritableDataAndCallsNothing) {
  if (!hasProgram("gcc") || !hasProgram("nm")) GTEST_SKIP() << "no gcc or nm";
  const MadeMap made(makeSmallMap());
  const ScratchFolder folder;
  saveCode(folder, made.map, codeOptions());
  ASSERT_EQ(runCommand(folder, "gcc -std=c99 -O2 -c code.c && nm code.o"), 0);
  const std::string symbols = logOf(folder);
  for (const char* const kind : {" U ", " D ", " d ", " B ", " b ", " C "})
    EXPECT_EQ(symbols.find(kind), std::string::npos) << symbols;
}

TEST(ExportMapText, TheSameMapGivesTheSameText) {
  const MadeMap made(makeSmallMap());
  const ExportOptions options = codeOptions();
  EXPECT_EQ(exportSource(made.map, options), exportSource(made.map, options));
  EXPECT_EQ(exportTest(made.map, options, noError(made.map)),
            exportTest(made.map, options, noError(made.map)));
}

TEST(ExportMapText, SignalsCannotEndTheComment) {
  MapContent content = makeSmallMap();
  content.parameters[0].name = "a*/ #error \\ ?\?/ \xc2\xb5";
  const std::string header = exportHeader(MadeMap(content).map, codeOptions(), {{0.0}, 0.0, {}, {}});
  EXPECT_NE(header.find("a_/ #error _ __/ \xc2\xb5"), std::string::npos) << header;
}

TEST(ExportMapNames, OnlyIdentifiersAreAccepted) {
  for (const char* const name :
       {"", "1a", "_a", "a-b", "a/b", "abcdefghijklmnopqrstuvwxy", "a b", "\xc2\xb5"})
    EXPECT_NE(errorOf([name] { checkExportName(name); }).find("--name"), std::string::npos) << name;
  for (const char* const name : {"a", "lateral_2", "abcdefghijklmnopqrstuvwx"}) checkExportName(name);
}

}  // namespace
}  // namespace polyfly
