// The engine's regions against those found by trying every active set.
#include "brute_force.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "made_program.hpp"
#include "map_in_memory.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "reference_problems.hpp"

namespace polyfly {
namespace {

// Smaller regions are left out of the count.
constexpr double kLeastRadius = 1e-7;  // [half ranges]
// Greatest allowed error of z.
constexpr double kTolerance = 1e-8;

void expectSameRegions(const ParametricProgram& program) {
  const BruteForce brute_force(program, kLeastRadius);
  const Partition partition = explore(program);
  if (brute_force.regions().empty()) {
    EXPECT_EQ(partition.status, ExploreStatus::kInfeasible) << program.name;
    return;
  }
  ASSERT_EQ(partition.status, ExploreStatus::kComplete) << program.name << ": " << toString(partition.status);
  std::size_t regions = 0;
  for (const CriticalRegion& region : partition.regions) regions += region.radius >= kLeastRadius;
  EXPECT_EQ(regions, brute_force.regions().size()) << program.name;

  const MapInMemory memory(encode(program, partition));
  std::vector<double> u(program.inputs.size());
  for (const auto& [rows, region] : brute_force.regions()) {
    const Lookup lookup = memory.map().evaluate(region.centre.data(), u.data());
    ASSERT_EQ(lookup.status, LookupStatus::kInside) << program.name << " at " << region.centre.transpose();
    const Eigen::VectorXd z = region.K * region.centre + region.k;
    const Eigen::VectorXd expected = program.E * z + program.C * region.centre + program.c;
    for (std::size_t i = 0; i < u.size(); ++i) {
      EXPECT_NEAR(u[i], expected[static_cast<Eigen::Index>(i)], kTolerance) << program.name;
    }
  }
}

TEST(BruteForce, AgreesOnRandomPrograms) {
  const ProgramSize sizes[] = {{1, 2, 1},  {2, 4, 1}, {2, 6, 2},  {3, 8, 2},
                               {3, 10, 3}, {4, 8, 3}, {4, 12, 2}, {5, 10, 4}};
  for (const ProgramSize& size : sizes) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      SCOPED_TRACE(std::to_string(size.variables) + " variables, seed " + std::to_string(seed));
      expectSameRegions(madeProgram(seed, size));
    }
  }
}

TEST(BruteForce, AgreesWithEqualities) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ParametricProgram program = madeProgram(seed, {4, 10, 2});
    program.equalities = {3, 7};
    program.b[3] = program.b[7] = 0.0;
    expectSameRegions(program);
  }
}

// A polytope of parameters, and a program that is infeasible in parts of it.
TEST(BruteForce, AgreesWherePartsAreInfeasible) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ParametricProgram program = madeProgram(seed, {3, 9, 2});
    program.S *= 6.0;
    program.A_theta.resize(1, 2);
    program.A_theta << 1.0, 1.0;
    program.b_theta.resize(1);
    program.b_theta << 0.7;
    expectSameRegions(program);
  }
}

// Rows on a coarse grid meet in more than n at a point and repeat each other.
TEST(BruteForce, AgreesOnDegeneratePrograms) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ParametricProgram program = madeProgram(seed, {3, 8, 2});
    Random random(seed);
    program.H = Eigen::MatrixXd::Identity(3, 3);
    for (Eigen::Index i = 0; i < 8; ++i) {
      do {
        for (Eigen::Index j = 0; j < 3; ++j) program.A(i, j) = random.below(3) - 1;
      } while (program.A.row(i).isZero());
      program.b[i] = 1.0;
      for (Eigen::Index j = 0; j < 2; ++j) program.S(i, j) = 0.5 * (random.below(3) - 1);
    }
    for (Eigen::Index i = 0; i < 3; ++i) {
      for (Eigen::Index j = 0; j < 2; ++j) program.F(i, j) = 4.0 * (random.below(3) - 1);
    }
    expectSameRegions(program);
  }
}

class SmallReference : public testing::TestWithParam<const char*> {};

TEST_P(SmallReference, HasTheRegionsOfBruteForce) {
  const std::filesystem::path folder = referenceProblems();
  if (folder.empty())
    GTEST_SKIP() << "The reference problems are not here: set POLYFLY_DATA to their folder.";
  expectSameRegions(loadProgram((folder / (std::string(GetParam()) + ".json")).string()));
}

std::string testName(const testing::TestParamInfo<const char*>& info) { return info.param; }

INSTANTIATE_TEST_SUITE_P(All, SmallReference,
                         testing::Values("bemporad2002", "di_N2", "di_N5", "di_N5_xf0_eq", "invpend_N5",
                                         "multirotor_N5", "rnd_n3_m20_t4", "deg_facet_to_facet",
                                         "deg_licq_ahmadi", "deg_scs_lowdim"),
                         testName);

}  // namespace
}  // namespace polyfly
