// Explores the reference problems and compares the maps with solutions that other programs computed.
#include "reference_problems.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "map_in_memory.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"

namespace polyfly {
namespace {

// Samples with a greater KKT residual are no reference.
constexpr double kSampleAccuracy = 1e-8;
// Samples nearer to the edge of the feasible set are not decided.
constexpr double kMargin = 1e-6;
// Every program keeps regions with this radius.
constexpr double kCertainRadius = 2e-6;  // [scaled]
constexpr std::size_t kManyRegions = 1000;
// Greatest allowed error of u.
constexpr double kTolerance = 1e-7;

const char* const kStrictlyConvex[] = {"bemporad2002",
                                       "di_N2",
                                       "di_N5",
                                       "di_N10",
                                       "di_N15",
                                       "di_N5_xf0_eq",
                                       "invpend_N5",
                                       "invpend_N5_x",
                                       "multirotor_N5",
                                       "multirotor_N10",
                                       "multirotor_N20",
                                       "multirotor_N10_soft",
                                       "mass_spring4_N5",
                                       "mass_spring4_N10",
                                       "mass_spring6_N5",
                                       "rnd_n3_m20_t4",
                                       "rnd_n5_m40_t3",
                                       "rnd_n6_m20_t3",
                                       "rnd_n10_m20_t4",
                                       "deg_licq_ahmadi",
                                       "deg_facet_to_facet",
                                       "deg_scs_lowdim",
                                       "deg_di_N5_dup",
                                       "deg_di_N5_xf0_ineq",
                                       "invpend_track_Np50_Nc5"};

class ReferenceProblem : public testing::TestWithParam<const char*> {};

// Number of regions on which the published results agree, counting only runs that ended well and missed
// nothing.
std::set<std::size_t> publishedCounts(const nlohmann::json& results) {
  std::set<std::size_t> counts;
  for (const auto& [tool, run] : results.items()) {
    if (!run.is_object() || !run.contains("regions") || !run["regions"].is_number()) continue;
    const bool ended = !run.contains("status") || run["status"] == "Solved";
    if (!ended || run.value("samples_missed", 1) != 0) continue;
    counts.insert(run["regions"].get<std::size_t>());
  }
  return counts;
}

void checkSamples(const RegionMap& map, const nlohmann::json& samples) {
  std::size_t compared = 0;
  for (const auto& sample : samples) {
    const auto theta = sample["theta"].get<std::vector<double>>();
    std::vector<double> u(map.inputs().size());
    const Lookup lookup = map.evaluate(theta.data(), u.data());
    if (!sample["feasible"].get<bool>()) {
      if (sample.contains("margin") && sample["margin"].is_number() &&
          sample["margin"].get<double>() > -kMargin)
        continue;
      EXPECT_EQ(lookup.status, LookupStatus::kOutsidePartition) << "theta " << sample["theta"];
      continue;
    }
    if (sample["kkt"].get<double>() > kSampleAccuracy) continue;
    ASSERT_EQ(lookup.status, LookupStatus::kInside) << "theta " << sample["theta"];
    const auto expected = sample["u"].get<std::vector<double>>();
    ASSERT_EQ(expected.size(), u.size());
    for (std::size_t i = 0; i < u.size(); ++i) {
      EXPECT_NEAR(u[i], expected[i], kTolerance * (1.0 + std::abs(expected[i])))
          << "theta " << sample["theta"];
    }
    ++compared;
  }
  EXPECT_GT(compared, 10u);
}

TEST_P(ReferenceProblem, AgreesWithSolutionsOfOtherPrograms) {
  const std::filesystem::path folder = referenceProblems();
  if (folder.empty())
    GTEST_SKIP() << "The reference problems are not here: set POLYFLY_DATA to their folder.";
  const std::string name = GetParam();
  const nlohmann::json problem = readJson(folder / (name + ".json"));
  const ParametricProgram program = loadProgram((folder / (name + ".json")).string());
  const Partition partition = explore(program);
  ASSERT_EQ(partition.status, ExploreStatus::kComplete) << toString(partition.status);
  TreeOptions tree;
  if (partition.regions.size() > kManyRegions)
    tree.node_limit = 255;  // quickly built; the answers are the same
  const MapInMemory memory(encode(program, partition, tree));
  checkSamples(memory.map(), problem["samples"]);

  const std::size_t regions = partition.regions.size();
  RecordProperty("regions", static_cast<int>(regions));
  if (problem["expected"].contains("full_dim_regions")) {
    EXPECT_EQ(regions, problem["expected"]["full_dim_regions"].get<std::size_t>());
  }
  // Of di_N5 with every row twice, others publish overlapping copies: the partition is that of di_N5.
  const std::string counted = name == "deg_di_N5_dup" ? "di_N5" : name;
  const std::set<std::size_t> counts =
      publishedCounts(readJson(folder / "reference_results.json")["main"][counted]);
  if (counts.empty()) return;
  // Some leave out regions below a radius of about 1e-6, others keep them; overlaps count twice with some.
  const auto wide =
      std::count_if(partition.regions.begin(), partition.regions.end(),
                    [](const CriticalRegion& region) { return region.radius > kCertainRadius; });
  EXPECT_GE(regions, *counts.begin());
  EXPECT_LE(static_cast<std::size_t>(wide), *counts.rbegin());
}

std::string testName(const testing::TestParamInfo<const char*>& info) { return info.param; }

INSTANTIATE_TEST_SUITE_P(All, ReferenceProblem, testing::ValuesIn(kStrictlyConvex), testName);

}  // namespace
}  // namespace polyfly
