#pragma once

#include <array>
#include <cstdint>
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

/// Times of the phases [s].
struct PhaseSeconds {
  double load = 0.0;
  double explore = 0.0;
  double encode = 0.0;
  double check = 0.0;
  double write = 0.0;
};

constexpr std::array<double PhaseSeconds::*, 5> kPhases = {&PhaseSeconds::load, &PhaseSeconds::explore,
                                                           &PhaseSeconds::encode, &PhaseSeconds::check,
                                                           &PhaseSeconds::write};

/// How long the phases took, and what they took of the processors.
class PhaseClock {
 public:
  PhaseSeconds seconds;
  /// Of this process until `leave`, then of all.
  PhaseSeconds cpu;

  void end(double PhaseSeconds::*phase) {
    seconds.*phase += watch_.lap();
    cpu.*phase += cpu_watch_.lap();
  }

  /// Leaves the group, and adds what the other processes took of their processors.
  void leave(MpiSession& session) {
    for (std::size_t i = 0; i < session.cpu.size(); ++i) session.cpu[i] = cpu.*kPhases[i];
    session.leave();
    for (std::size_t i = 0; i < session.cpu.size(); ++i) cpu.*kPhases[i] = session.cpu[i];
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
               const PhaseSeconds& seconds);

}  // namespace polyfly
