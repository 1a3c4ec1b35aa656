#pragma once

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "offline_mpt/encode.hpp"
#include "project_root.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "robust_mpc/robust_law.hpp"
#include "robust_mpc/robust_problem.hpp"

namespace polyfly {

/// The map of a robust problem, solved into a file of this name in the tests' folder.
inline RegionMap solvedRobustMap(const RobustProblem& problem, const std::string& name) {
  const RobustLaw law = explicitLaw(problem, projectFeasibleSet(buildRobustProgram(problem)));
  const RoundedLaw rounded = roundLaw(problem, law, ExploreStatus::kComplete);
  const std::string path = testing::TempDir() + name + ".map";
  writeMap(encode(rounded.program, rounded.partition), path);
  return RegionMap::open(path);
}

/// The maps of the ASLquad's three axes, longitudinal first; their files' names begin with `prefix`.
inline std::vector<RegionMap> aslquadMaps(const std::string& prefix) {
  std::vector<RegionMap> maps;
  for (const std::string axis : {"longitudinal", "lateral", "vertical"}) {
    const RobustProblem problem = loadRobustProblem(problemFile("robust/aslquad_" + axis + ".yaml"));
    maps.push_back(solvedRobustMap(problem, prefix + axis));
  }
  return maps;
}

}  // namespace polyfly
