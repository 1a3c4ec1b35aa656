// Leaves of a reduced map that miss a row or a candidate are mended.
#include <algorithm>

#include "exact_programs.hpp"
#include "map_in_memory.hpp"
#include "mutation.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "offline_mpt/reduce.hpp"
#include "offline_mpt/verify_reduction.hpp"
#include "random_program.hpp"
#include "reduction_mutation.hpp"

namespace polyfly {
namespace {

// The tree of a reduced map must not leave them to a neighbour that does not hold them.
TEST(RepairLeaves, LongAndThinSliversNeedNone) {
  ReductionOptions options;
  options.certificate = true;
  for (unsigned seed = 236; seed <= 250; ++seed) {
    const ParametricProgram program = illConditioned(3, 5, 3, seed);
    const MapInMemory original(encode(program, explore(program)));
    const MapInMemory reduced(reduce(original.map()).content);
    const ReductionReport report = verifyReduction(reduced.map(), original.map(), options);
    ASSERT_TRUE(report.passed()) << seed << "\n" << reductionText(report);
    EXPECT_EQ(reductionRefusal(report.certificate, reduced.bytes(), original.bytes()), "");
  }
}

class LeafRepair : public ::testing::Test {
 protected:
  LeafRepair()
      : program_(unbounded(randomProgram(4, 12, 2, 3))),
        original_(encode(program_, explore(program_))),
        content_(reduce(original_.map()).content) {}

  static ParametricProgram unbounded(ParametricProgram program) {
    withoutBounds(program);
    return program;
  }

  ReductionReport report() const { return verifyReduction(MapInMemory(content_).map(), original_.map()); }

  ParametricProgram program_;
  MapInMemory original_;
  MapContent content_;
};

TEST(RepairLeaves, AddsARowThatALeafMustTest) {
  const ParametricProgram program = doubleIntegrator(5);
  const MapInMemory original(encode(program, explore(program)));
  ReduceOptions options;
  options.tree = TreeMode::kSmall;
  const MapContent whole = reduce(original.map(), options).content;
  int mended = 0;
  for (std::size_t k = 0; k < whole.tests.size(); ++k) {
    if (whole.tests[k] == 0) continue;
    MapContent content = whole;
    content.tests[k] &= content.tests[k] - 1;
    const ReductionReport found = verifyReduction(MapInMemory(content).map(), original.map());
    // The tree keeps a row that touches its cell.
    if (found.passed()) continue;
    EXPECT_EQ(found.defects.front().kind, ReductionDefect::Kind::kAnswer);
    ASSERT_TRUE(repairLeaves(content, found));
    EXPECT_TRUE(verifyReduction(MapInMemory(content).map(), original.map()).passed()) << k;
    ++mended;
  }
  EXPECT_GT(mended, 10);
}

TEST_F(LeafRepair, TestsAllRowsWhereDistancesAreComputedTooRoughly) {
  content_.tests.assign(content_.candidates.size(), 1);
  ReductionDefect rough;
  rough.kind = ReductionDefect::Kind::kAnswer;
  ReductionReport found;
  found.defects.push_back(rough);
  ASSERT_TRUE(repairLeaves(content_, found));
  EXPECT_TRUE(content_.tests.empty());
  EXPECT_FALSE(repairLeaves(content_, found));
}

TEST_F(LeafRepair, AddsACandidateThatALeafLacks) {
  ASSERT_TRUE(report().passed());
  const MapContent whole = content_;
  int mended = 0;
  for (std::size_t k = 0; k < whole.leaves.size(); ++k) {
    content_ = whole;
    const auto first = content_.candidates.begin() + static_cast<std::ptrdiff_t>(content_.leaves[k].first);
    const auto last = first + static_cast<std::ptrdiff_t>(content_.leaves[k].count);
    std::uint32_t another = 0;
    while (std::find(first, last, another) != last) ++another;
    *first = another;
    ReductionReport found = report();
    // The other candidates may hold the whole cell.
    if (found.passed()) continue;
    EXPECT_EQ(found.defects.front().leaf, static_cast<int>(k));
    while (!found.passed() && repairLeaves(content_, found)) found = report();
    EXPECT_TRUE(found.passed()) << k << "\n" << reductionText(found);
    EXPECT_GT(content_.leaves[k].count, whole.leaves[k].count);
    ++mended;
  }
  EXPECT_GT(mended, 3);
}

TEST_F(LeafRepair, DoesNotHelpWhereALawIsWrong) {
  content_.laws[0] += 1e-3;
  const ReductionReport found = report();
  ASSERT_FALSE(found.passed());
  EXPECT_FALSE(repairLeaves(content_, found));
}

}  // namespace
}  // namespace polyfly
