// A short soak, seeded: everything goes wrong at random, and nothing comes of it.
#include "polyfly_test/soak.hpp"

#include <gtest/gtest.h>

#include <string>

#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "project_root.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly_test {
namespace {

TEST(Soak, BoundsHoldAndEveryFaultIsRecoveredFrom) {
  SoakLaws laws;
  std::vector<polyfly::RegionMap> opened;
  opened.reserve(6);
  for (const double factor : {1.0, 1.3}) {  // two sets of maps, of other weights
    for (std::size_t i = 0; i < 3; ++i) {
      const char* axes[] = {"longitudinal", "lateral", "vertical"};
      polyfly::MpcProblem problem =
          polyfly::loadProblem(polyfly::problemFile(std::string("multirotor_") + axes[i] + ".yaml"));
      if (factor == 1.0) laws.problems[i] = problem;
      problem.Q(0, 0) *= factor;
      const polyfly::ParametricProgram program = polyfly::condense(problem);
      const std::string path = testing::TempDir() + "soak_test_" + axes[i] + std::to_string(factor) + ".map";
      polyfly::writeMap(polyfly::encode(program, polyfly::explore(program)), path);
      opened.push_back(polyfly::RegionMap::open(path));
    }
  }
  laws.maps = {{&opened[0], &opened[1], &opened[2]}, {&opened[3], &opened[4], &opened[5]}};

  SoakOptions options;
  options.duration = 150.0;
  const SoakResult result = soak(laws, options);
  EXPECT_TRUE(result.violations.empty())
      << result.violations.size() << ", first: " << result.violations.front();
  EXPECT_EQ(result.samples, 15000);
  EXPECT_GT(result.recoveries, 8);
  EXPECT_GT(result.failsafe, 50);
  EXPECT_GT(result.swaps, 10);
  EXPECT_GT(result.reconfigurations, 20);
  EXPECT_GT(result.selections, 10);
  EXPECT_LT(result.allocated_growth, 1 << 20);  // sets of laws come and go
  EXPECT_GT(result.silences + result.not_numbers + result.jumps + result.out_of_order + result.wrong_frames +
                result.huge,
            8);
}

}  // namespace
}  // namespace polyfly_test
