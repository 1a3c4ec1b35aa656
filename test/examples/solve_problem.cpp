// Solves a problem for all parameters and writes the region map: solve_problem PROBLEM MAP
#include <cstdio>

#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/write_map.hpp"

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fprintf(stderr, "usage: solve_problem PROBLEM MAP\n");
    return 2;
  }
  const polyfly::ParametricProgram program = polyfly::loadProgram(argv[1]);
  const polyfly::Partition partition = polyfly::explore(program);
  if (partition.status != polyfly::ExploreStatus::kComplete) {
    std::fprintf(stderr, "%s: %s\n", argv[1], polyfly::toString(partition.status));
    return 1;
  }
  polyfly::writeMap(polyfly::encode(program, partition), argv[2]);
  std::printf("%zu regions\n", partition.regions.size());
  return 0;
} catch (const polyfly::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
