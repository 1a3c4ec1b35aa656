// Counts against whole partitions; every record of a proof against its conditions in fractions; proofs that
// are changed against their checker.
#include "offline_mpt/count.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "count_oracle.hpp"
#include "count_proof.hpp"
#include "made_program.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "polyfly_base/error.hpp"
#include "reference_problems.hpp"
#include "region_maps/write_map.hpp"
#include "scratch_folder.hpp"

namespace polyfly {
namespace {

// Records of a proof that are checked in fractions.
constexpr std::size_t kRecordsChecked = 40;
const ProgramSize kSizes[] = {{2, 6, 2}, {3, 12, 2}, {4, 14, 3}, {5, 16, 4}, {6, 18, 3}, {3, 24, 4}};

/// z in a box, so that differences of laws can be told: |z_j| <= 3.
ParametricProgram boundedProgram(std::uint64_t seed, const ProgramSize& size) {
  ParametricProgram program = madeProgram(seed, size);
  const int n = size.variables, m = size.rows;
  program.A.conservativeResize(m + 2 * n, Eigen::NoChange);
  program.b.conservativeResize(m + 2 * n);
  program.S.conservativeResize(m + 2 * n, Eigen::NoChange);
  program.A.bottomRows(2 * n) << Eigen::MatrixXd::Identity(n, n), -Eigen::MatrixXd::Identity(n, n);
  program.b.tail(2 * n).setConstant(3.0);
  program.S.bottomRows(2 * n).setZero();
  return program;
}

class Count : public testing::Test {
 protected:
  CountResult count(const ParametricProgram& program, CountOptions options = {}) const {
    options.proof = proof();
    return countRegions(program, options);
  }
  std::string proof() const { return folder_.path("p.count"); }

  /// What the checker says of a changed proof; empty: confirmed.
  std::string refusal(const std::string& bytes) const {
    const std::string path = folder_.path("changed.count");
    std::ofstream(path, std::ios::binary) << bytes;
    try {
      checker::CountProof(path).check(2);
    } catch (const checker::Refused& refused) {
      return refused.what();
    }
    return "";
  }

  ScratchFolder folder_;
};

// Nothing but `result` and the file: is every record right, and is none twice?
void expectRightRecords(const ParametricProgram& program, const CountResult& result, const std::string& path,
                        const std::vector<int>& silent = {}) {
  const std::vector<CountedSet> sets = readCountProof(program, path);
  ASSERT_EQ(sets.size(), result.count.proven);
  std::set<std::vector<int>> distinct;
  std::uint64_t rows = 0;
  for (std::size_t k = 0; k < sets.size(); ++k) {
    EXPECT_TRUE(distinct.insert(sets[k].rows).second) << program.name << ": record " << k << " again";
    rows += sets[k].rows.size();
    if (k % std::max<std::size_t>(1, sets.size() / kRecordsChecked) == 0) {
      EXPECT_TRUE(strictlyOptimal(program, sets[k], silent)) << program.name << ": record " << k;
    }
  }
  EXPECT_EQ(rows, result.count.active_rows);
  const checker::Size size = checker::CountProof(path).check(1);
  EXPECT_EQ(size.regions, result.count.proven);
  EXPECT_EQ(size.active_rows, result.count.active_rows);
  EXPECT_GE(size.laws, result.count.laws) << "the checker rounds less";
  EXPECT_GE(size.bytes, result.map_bytes);
}

// The map is at least as large as the count says, and has as many laws.
void expectRightBounds(const ParametricProgram& program, const Partition& partition,
                       const CountResult& result) {
  const MapContent map = encode(program, partition);
  EXPECT_GE(map.laws.size() / (map.inputs.size() * (map.parameters.size() + 1)), result.count.laws);
  EXPECT_GE(layOut(map).size(), result.map_bytes);
}

TEST_F(Count, OfRandomProgramsIsThatOfTheWholePartition) {
  for (const ProgramSize& size : kSizes) {
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const ParametricProgram program = boundedProgram(seed, size);
      const Partition partition = explore(program);
      const CountResult result = count(program);
      ASSERT_EQ(partition.status, ExploreStatus::kComplete);
      EXPECT_EQ(result.status, ExploreStatus::kComplete);
      EXPECT_EQ(result.regions, partition.regions.size()) << program.name;
      EXPECT_EQ(result.count.proven, partition.regions.size()) << program.name;
      EXPECT_EQ(result.unproven + result.open + result.contradicted, 0u);
      EXPECT_EQ(result.count.laws, partition.regions.size()) << "the output is z: no two laws are equal";
      expectRightRecords(program, result, proof());
      expectRightBounds(program, partition, result);
    }
  }
}

TEST_F(Count, StoppedEarlyHoldsRegionsOfTheWholePartitionOnly) {
  const ParametricProgram program = madeProgram(3, {6, 18, 4});
  const Partition partition = explore(program);
  std::set<std::vector<int>> active;
  for (const CriticalRegion& region : partition.regions) active.insert(region.active);
  std::size_t at_open_sets = 0;
  for (const std::uint64_t limit : {1, 5, 40, 100}) {
    CountOptions options;
    options.region_limit = limit;
    const CountResult result = count(program, options);
    EXPECT_EQ(result.status, ExploreStatus::kLimited);
    EXPECT_GE(result.count.proven, limit);
    EXPECT_LT(result.count.proven, partition.regions.size());
    at_open_sets += result.count.proven > result.described;
    expectRightRecords(program, result, proof());
    for (const CountedSet& set : readCountProof(program, proof())) EXPECT_EQ(active.count(set.rows), 1u);
  }
  EXPECT_GT(at_open_sets, 0u) << "no open set was counted";
}

// Few rows fix z: behind most facets one active row takes the place of another, and which one depends on the
// place. A set that the ray through one facet misses is met through others.
TEST_F(Count, ProvesMostSetsBeforeItDescribesThemWhereRowsTakeEachOthersPlace) {
  const ParametricProgram program = boundedProgram(7, {4, 30, 5});
  const Partition partition = explore(program);
  ASSERT_GT(partition.stats.degenerate_facets, partition.regions.size());
  const CountResult whole = count(program);
  EXPECT_EQ(whole.count.proven, partition.regions.size());
  EXPECT_EQ(whole.unproven + whole.contradicted, 0u);
  expectRightRecords(program, whole, proof());
  CountOptions options;
  options.region_limit = whole.regions * 95 / 100;
  const CountResult most = count(program, options);
  EXPECT_LT(most.described, whole.described / 3);
  expectRightRecords(program, most, proof());
}

TEST_F(Count, DoesNotDependOnThreads) {
  for (const ProgramSize& size : {ProgramSize{6, 20, 4}, ProgramSize{3, 40, 4}}) {
    const ParametricProgram program = madeProgram(5, size);
    for (const std::uint64_t limit : {300, 0}) {
      CountOptions options;
      options.region_limit = limit;
      const CountResult one = count(program, options);
      const std::string bytes = readBytes(proof());
      for (const int threads : {2, 4}) {
        options.threads = threads;
        const CountResult many = count(program, options);
        EXPECT_EQ(one.count.proven, many.count.proven);
        EXPECT_EQ(one.described, many.described);
        EXPECT_EQ(one.unproven, many.unproven);
        EXPECT_EQ(readBytes(proof()), bytes)
            << program.name << ", " << limit << ", " << threads << " threads";
      }
    }
  }
}

TEST_F(Count, StopsWhenTheMapIsTooLarge) {
  const ParametricProgram program = madeProgram(5, {6, 20, 4});
  const CountResult whole = count(program);
  ASSERT_EQ(whole.status, ExploreStatus::kComplete);
  CountOptions options;
  options.map_limit = whole.map_bytes / 2;
  const CountResult half = count(program, options);
  EXPECT_EQ(half.status, ExploreStatus::kLimited);
  EXPECT_GT(half.map_bytes, options.map_limit);
  EXPECT_LT(half.count.proven, whole.count.proven);
  EXPECT_GT(checker::CountProof(proof()).check(1).bytes, options.map_limit);
  options.map_limit = whole.map_bytes;
  EXPECT_EQ(count(program, options).status, ExploreStatus::kComplete);
}

TEST_F(Count, RowsThatRepeatExactlyAreNoObstacle) {
  ParametricProgram program = madeProgram(2, {3, 10, 2});
  const CountResult once = count(program);
  for (const int row : {1, 4, 7}) {
    const Eigen::VectorXd a = 4.0 * program.A.row(row), s = 4.0 * program.S.row(row);
    const Eigen::Index m = program.A.rows();
    program.A.conservativeResize(m + 1, Eigen::NoChange);
    program.b.conservativeResize(m + 1);
    program.S.conservativeResize(m + 1, Eigen::NoChange);
    program.A.row(m) = a;
    program.b(m) = 4.0 * program.b(row);
    program.S.row(m) = s;
  }
  const CountResult twice = count(program);
  EXPECT_EQ(twice.count.proven, once.count.proven);
  EXPECT_EQ(twice.unproven, 0u);
  expectRightRecords(program, twice, proof(), {10, 11, 12});
}

TEST_F(Count, SaysHowManyRegionsItDoesNotProve) {
  ParametricProgram program = madeProgram(2, {3, 10, 2});
  const Eigen::Index m = program.A.rows();
  program.A.conservativeResize(m + 1, Eigen::NoChange);
  program.b.conservativeResize(m + 1);
  program.S.conservativeResize(m + 1, Eigen::NoChange);
  // The same row, but for rounding.
  program.A.row(m) = program.A.row(0) * (1.0 + 0x1.0p-50);
  program.b(m) = program.b(0);
  program.S.row(m) = program.S.row(0);
  const CountResult result = count(program);
  EXPECT_EQ(result.status, ExploreStatus::kComplete);
  EXPECT_EQ(result.regions, explore(program).regions.size());
  EXPECT_EQ(result.regions, result.count.proven + result.unproven);
  EXPECT_GT(result.unproven, 0u);
  EXPECT_GT(result.count.proven, 0u);
  expectRightRecords(program, result, proof());
}

TEST_F(Count, RefusesCostsThatAreNotStrictlyConvex) {
  ParametricProgram program = madeProgram(1, {2, 6, 2});
  program.H(1, 1) = program.H(0, 1) = program.H(1, 0) = 0.0;
  EXPECT_THROW(countRegions(program), Error);
  program.H.setZero();
  EXPECT_THROW(countRegions(program), Error);
}

TEST_F(Count, OfReferenceProblemsIsThatOfTheWholePartition) {
  const std::filesystem::path folder = referenceProblems();
  if (folder.empty()) GTEST_SKIP() << "the reference problems are not at hand";
  for (const char* name : {"bemporad2002", "di_N10", "di_N5_xf0_eq", "invpend_N5_x", "invpend_track_Np50_Nc5",
                           "mass_spring4_N5", "mass_spring4_N10", "multirotor_N20", "rnd_n5_m40_t3",
                           "rnd_n6_m20_t3", "deg_licq_ahmadi", "deg_facet_to_facet", "deg_di_N5_dup"}) {
    const ParametricProgram program = loadProgram((folder / (std::string(name) + ".json")).string());
    const Partition partition = explore(program);
    const CountResult result = count(program);
    EXPECT_EQ(result.status, ExploreStatus::kComplete) << name;
    EXPECT_EQ(result.regions, partition.regions.size()) << name;
    EXPECT_EQ(result.count.proven, partition.regions.size()) << name;
    EXPECT_EQ(checker::CountProof(proof()).check(2).regions, result.count.proven) << name;
    expectRightBounds(program, partition, result);
  }
}

// Rows that are tight all over a region without a multiplier, or opposite to others: no strict optimum there.
TEST_F(Count, OfDegenerateReferenceProblemsSaysWhatIsNotProven) {
  const std::filesystem::path folder = referenceProblems();
  if (folder.empty()) GTEST_SKIP() << "the reference problems are not at hand";
  for (const char* name : {"multirotor_N10_soft", "deg_di_N5_xf0_ineq"}) {
    const ParametricProgram program = loadProgram((folder / (std::string(name) + ".json")).string());
    const CountResult result = count(program);
    EXPECT_EQ(result.status, ExploreStatus::kComplete) << name;
    EXPECT_EQ(result.regions, explore(program).regions.size()) << name;
    EXPECT_EQ(result.count.proven + result.unproven, result.regions) << name;
    EXPECT_GT(result.unproven, 0u) << name;
  }
}

TEST_F(Count, AChangedProofIsRefused) {
  const ParametricProgram program = madeProgram(4, {4, 14, 3});
  const CountResult result = count(program);
  const std::string right = readBytes(proof());
  const std::size_t record = 2 + 5 * 3;
  const std::size_t first = right.size() - record * result.count.proven;
  ASSERT_EQ(refusal(right), "");
  ASSERT_GE(result.count.proven, 20u);
  for (std::size_t k = 0; k < 20; ++k) {
    for (int row = 0; row < 14; ++row) {  // a set with one row more or less is not optimal there
      std::string changed = right;
      char& byte = changed[first + k * record + static_cast<std::size_t>(row) / 8];
      byte = static_cast<char>(byte ^ 1 << row % 8);
      EXPECT_NE(refusal(changed), "") << "record " << k << ", row " << row;
    }
    // Takes the witness of another set.
    std::string moved = right;
    moved.replace(first + k * record + 2, record - 2, right, first + (k + 1) * record + 2, record - 2);
    EXPECT_NE(refusal(moved), "") << "record " << k;
    EXPECT_NE(refusal(right + right.substr(first + k * record, record)).find("twice"), std::string::npos);
  }
  // Moves the witness as far down as possible, to the edge of the box.
  std::string outside = right;
  outside.replace(first + 2, 5, std::string("\0\0\0\0\x80", 5));
  EXPECT_NE(refusal(outside), "");
  EXPECT_NE(refusal(right.substr(0, right.size() - 3)), "");
  EXPECT_EQ(refusal(right.substr(0, right.size() - record)), "") << "every record stands for itself";
  EXPECT_NE(refusal(right.substr(0, first)), "") << "no record";
  for (const char* name : {"\nequalities ", "\nweights ", "\nA "}) {  // a line of the head left out, or twice
    const std::size_t at = right.find(name);
    const std::string line = right.substr(at, right.find('\n', at + 1) - at);
    EXPECT_NE(refusal(right.substr(0, at) + right.substr(at + line.size())), "") << name;
    EXPECT_NE(refusal(right.substr(0, at) + line + right.substr(at)), "") << name;
  }
  for (const char* name : {"\nH ", "\nA ", "\nb ", "\nF ", "\nS ", "\nweights "}) {
    // Changes the sign of the first number.
    std::string changed = right;
    std::size_t at = changed.find(name) + std::string(name).size();
    for (int words = 0; words < 2; ++at) words += changed[at] == ' ';
    if (changed[at] == '-') {
      changed.erase(at, 1);
    } else {
      changed.insert(at, "-");
    }
    const bool is_zero = changed.compare(at, 4, "0x0p") == 0 || changed.compare(at, 5, "-0x0p") == 0;
    if (!is_zero) {
      EXPECT_NE(refusal(changed), "") << name;
    }
  }
}

}  // namespace
}  // namespace polyfly
