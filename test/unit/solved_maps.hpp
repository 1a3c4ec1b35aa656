#pragma once

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {

/// The maps of three problems, solved into files whose names begin with `prefix` in the tests' folder.
inline std::vector<RegionMap> solvedMaps(const std::array<MpcProblem, 3>& problems,
                                         const std::string& prefix) {
  std::vector<RegionMap> maps;
  for (const MpcProblem& problem : problems) {
    const ParametricProgram program = condense(problem);
    const std::string path = testing::TempDir() + prefix + program.name + ".map";
    writeMap(encode(program, explore(program)), path);
    maps.push_back(RegionMap::open(path));
  }
  return maps;
}

}  // namespace polyfly
