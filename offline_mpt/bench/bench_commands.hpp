#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/partition.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly::bench {

using Json = nlohmann::ordered_json;

struct SolveArguments {
  std::string problem;
  // Runs of problems that take less than a second each. Longer problems get fewer runs.
  int runs = 5;
  int threads = 1;
  // Time limit of one run.
  double time_limit = 60.0;  // [s]
};

struct LookupArguments {
  std::string problem;
  std::uint64_t seed = 1;
  std::size_t samples = 200000;
};

struct TreeArguments {
  std::string problem;
  // Of the tree whose leaves hold one law.
  double time_limit = 30.0;  // [s]
};

struct CertifyArguments {
  std::string problem;
  int threads = 1;
  double time_limit = 600.0;  // [s]
};

// Each measures one thing in this process and returns one flat object; offline.py says what is in it.
Json solveProblem(const SolveArguments& arguments);
Json timeLookups(const LookupArguments& arguments);
Json compareTrees(const TreeArguments& arguments);
Json timeCertificate(const CertifyArguments& arguments);
Json calibrate();

// Which map was measured: what its rows begin with.
Json sizesOf(const ParametricProgram& program, const Partition& partition, const RegionMap& map);

}  // namespace polyfly::bench
