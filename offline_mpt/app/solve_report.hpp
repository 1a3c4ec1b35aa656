#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "mpi_session.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "region_maps/region_map.hpp"
#include "stopwatch.hpp"

namespace polyfly {

/// What the command line of `solve` says.
struct SolveArguments {
  std::string problem;
  std::string map;
  std::string stats;
  ExploreOptions explore;
  double time_limit = 0.0;  // [s], of all phases
  TreeMode tree_mode = TreeMode::kAuto;
  std::uint64_t tree_nodes = 0;
  bool quiet = false;
  bool force = false;
};

/// How long the phases took, and what they took of the processors, in their order. [s]
class PhaseClock {
 public:
  nlohmann::ordered_json seconds = nlohmann::ordered_json::object();
  /// Of this process until `leave`, then of all.
  nlohmann::ordered_json cpu = nlohmann::ordered_json::object();

  /// What passed since the last call counts for this phase.
  void end(const char* phase) {
    seconds[phase] = seconds.value(phase, 0.0) + watch_.lap();
    cpu[phase] = cpu.value(phase, 0.0) + cpu_watch_.lap();
  }

  /// Leaves the group, and adds what the other processes took of their processors. All have ended the same phases.
  void leave(MpiSession& session) {
    session.cpu.clear();
    for (const auto& phase : cpu) session.cpu.push_back(phase);
    session.leave();
    auto sum = session.cpu.begin();
    for (auto& phase : cpu) phase = *sum++;
  }

 private:
  Stopwatch watch_;
  CpuStopwatch cpu_watch_;
};

/// Solves a problem of type robust_mpc.
ExitCode solveRobust(const SolveArguments& options);

/// The file that a stopped run leaves.
std::string checkpointOf(const SolveArguments& options);

bool isStopped(const Partition& partition);

/// The text of --stats.
std::string solveStats(const ParametricProgram& program, const Partition& partition, const RegionMap& map,
                       const PhaseClock& clock, int threads, int processes);

/// What stopped the exploration and where it can go on: to be said before the search tree takes its time.
void reportStop(const SolveArguments& options, const Partition& partition);

/// Of a run that was stopped, or left a gap: whoever goes on should know what it will lead to.
void reportUnbounded(const SolveArguments& options, const Partition& partition);

/// Of regions whose search tree is not built: where they are.
std::string whatRemains(const SolveArguments& options, const Partition& partition);

/// What the map is that was written.
void reportEnd(const SolveArguments& options, const Partition& partition, const RegionMap& map,
               const PhaseClock& clock);

}  // namespace polyfly
