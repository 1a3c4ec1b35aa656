// A short soak, seeded: everything goes wrong at random, and nothing comes of it.
#include "polyfly_test/soak.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "polyfly_base/read_text.hpp"
#include "project_root.hpp"
#include "region_maps/region_map.hpp"
#include "shipped_problems.hpp"
#include "solved_maps.hpp"
#include "solved_robust_maps.hpp"

namespace polyfly_test {
namespace {

polyfly::RegionMap solveRobust(const std::string& axis, int weight) {
  std::string text = polyfly::readText(polyfly::problemFile("robust/aslquad_" + axis + ".yaml"));
  const std::string stated = "tie_break: {Q: [40,";
  text.replace(text.find(stated), stated.size(), "tie_break: {Q: [" + std::to_string(weight) + ",");
  const polyfly::RobustProblem problem = polyfly::parseRobustProblem(text, axis);
  return polyfly::solvedRobustMap(problem, "soak_test_robust_" + axis + std::to_string(weight));
}

TEST(Soak, BoundsHoldAndEveryFaultIsRecoveredFrom) {
  SoakLaws laws;
  laws.problems = polyfly::shippedProblems();
  std::vector<std::vector<polyfly::RegionMap>> opened;
  for (const double factor : {1.0, 1.3}) {  // two sets of maps, of other weights
    std::array<polyfly::MpcProblem, 3> problems = laws.problems;
    for (polyfly::MpcProblem& problem : problems) problem.Q(0, 0) *= factor;
    opened.push_back(polyfly::solvedMaps(problems, "soak_test_" + std::to_string(factor)));
    laws.maps.push_back({&opened.back()[0], &opened.back()[1], &opened.back()[2]});
  }

  std::vector<polyfly::RegionMap> robust;
  robust.reserve(6);
  for (const int weight : {40, 30}) {
    for (const char* axis : {"longitudinal", "lateral", "vertical"})
      robust.push_back(solveRobust(axis, weight));
  }
  laws.robust_maps = {{&robust[0], &robust[1], &robust[2]}, {&robust[3], &robust[4], &robust[5]}};

  SoakOptions options;
  options.duration = 150.0;
  options.laws.emplace_back("robust_explicit");
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
