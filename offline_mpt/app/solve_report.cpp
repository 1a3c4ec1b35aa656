#include "solve_report.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "support/vector_text.hpp"

namespace polyfly {
namespace {

// More open sets than this for each region: most of them will not be regions.
constexpr std::uint64_t kManyOpenSets = 100;

// A longer look-up is not for flight: about half a millisecond on a small computer.
constexpr std::uint64_t kLongLookup = 200'000;  // multiply-adds

// Regions between such rows may be thinner than a map can have.
void reportNearRows(const SolveArguments& options, const Partition& partition) {
  if (partition.near_rows.empty()) return;
  std::string rows;
  for (const int row : partition.near_rows) rows += (rows.empty() ? "" : ", ") + std::to_string(row);
  std::printf(
      "%s: rows %s differ from another row by less than 1e-5: whether the map answers all between them, "
      "verify --exact decides\n",
      options.map.c_str(), rows.c_str());
}

}  // namespace

std::string checkpointOf(const SolveArguments& options) { return options.map + ".checkpoint"; }

bool isStopped(const Partition& partition) {
  return partition.status == ExploreStatus::kLimited || partition.status == ExploreStatus::kInterrupted;
}

std::string solveStats(const ParametricProgram& program, const Partition& partition, const RegionMap& map,
                       const PhaseClock& clock, int threads, int processes) {
  nlohmann::ordered_json json;
  json["name"] = program.name;
  json["status"] = toString(partition.status);
  json["variables"] = program.variableCount();
  json["rows"] = program.rowCount();
  json["parameters"] = program.parameterCount();
  json["inputs"] = program.inputCount();
  json["regions"] = partition.regions.size();
  json["candidate_sets"] = partition.stats.candidate_sets;
  json["degenerate_facets"] = partition.stats.degenerate_facets;
  json["lp_pivots"] = partition.stats.lp_pivots;
  json["open_sets"] = partition.stats.open_sets;
  json["resumed_regions"] = partition.stats.resumed_regions;
  json["explore_bytes"] = partition.stats.memory_bytes;
  json["cpu_seconds"] = clock.cpu["explore"];
  json["threads"] = threads;
  json["processes"] = processes;
  json["seconds"] = clock.seconds;
  json["phase_cpu_seconds"] = clock.cpu;
  json["laws"] = map.lawCount();
  json["planes"] = map.planeCount();
  json["nodes"] = map.nodeCount();
  json["leaves"] = map.leafCount();
  json["depth"] = map.cost().depth;
  json["region_checks"] = map.cost().region_checks;
  json["multiply_adds"] = map.cost().multiply_adds;
  json["bytes"] = map.bytes();
  if (partition.witness.size() > 0) json["witness"] = numbersOf(partition.witness);
  if (partition.unbounded_at.size() > 0) json["unbounded_at"] = numbersOf(partition.unbounded_at);
  return json.dump(2) + "\n";
}

void reportStop(const SolveArguments& options, const Partition& partition) {
  if (!isStopped(partition)) return;
  if (partition.stats.lost_process > 0) {
    std::fprintf(stderr, "offline_mpt: %s: process %d of the MPI job was lost after %zu regions\n",
                 options.map.c_str(), partition.stats.lost_process, partition.regions.size());
  }
  if (partition.regions.empty()) return;
  std::fprintf(stderr, "offline_mpt: %s: holds %zu regions and %llu open sets; continue with --resume\n",
               checkpointOf(options).c_str(), partition.regions.size(),
               static_cast<unsigned long long>(partition.stats.open_sets));
  if (partition.stats.open_sets > kManyOpenSets * (partition.regions.size() + 1)) {
    std::fprintf(
        stderr,
        "offline_mpt: %s: open sets grow faster than regions, because many bounds are active in many "
        "combinations within small distances; fewer moves (moves: [1, 1, 2, 4, ...]), a longer "
        "sampling_time or a smaller box leave fewer\n",
        options.problem.c_str());
  }
}

void reportUnbounded(const SolveArguments& options, const Partition& partition) {
  if (partition.unbounded_at.size() == 0 || partition.status == ExploreStatus::kUnbounded) return;
  std::fprintf(
      stderr,
      "offline_mpt: %s: the cost is unbounded below at theta = %s; explored to its end, it will be marked "
      "unbounded\n",
      options.map.c_str(), vectorText(partition.unbounded_at).c_str());
}

std::string whatRemains(const SolveArguments& options, const Partition& partition) {
  const std::string regions = std::to_string(partition.regions.size()) + " regions";
  return partition.stats.unsaved
             ? regions + " are lost"
             : checkpointOf(options) + " holds all " + regions + "; continue with --resume";
}

void reportEnd(const SolveArguments& options, const Partition& partition, const RegionMap& map,
               const PhaseClock& clock) {
  switch (partition.status) {
    case ExploreStatus::kComplete:
    case ExploreStatus::kInfeasible:
      break;
    case ExploreStatus::kIncomplete:
      std::fprintf(stderr,
                   "offline_mpt: %s: the partition has a gap at theta = %s; kept, marked incomplete\n",
                   options.map.c_str(), vectorText(partition.witness).c_str());
      break;
    case ExploreStatus::kUnbounded:
      std::fprintf(stderr,
                   "offline_mpt: %s: the cost is unbounded below at theta = %s; kept the regions of all "
                   "parameters with a finite optimum, marked unbounded\n",
                   options.map.c_str(), vectorText(partition.unbounded_at).c_str());
      break;
    case ExploreStatus::kLimited:
    case ExploreStatus::kInterrupted:
      std::fprintf(stderr, "offline_mpt: %s: %s: kept the %zu regions found so far, marked %s\n",
                   options.map.c_str(),
                   partition.status == ExploreStatus::kLimited ? "limit reached" : "interrupted",
                   partition.regions.size(), toString(partition.status));
      break;
  }
  if (map.cost().multiply_adds > kLongLookup) {
    std::fprintf(
        stderr,
        "offline_mpt: %s: the longest look-up takes %llu multiply-adds: not for flight; --tree auto or small "
        "shortens it\n",
        options.map.c_str(), static_cast<unsigned long long>(map.cost().multiply_adds));
  }
  if (options.quiet) return;
  reportNearRows(options, partition);
  std::printf("%s: %s, %zu regions, %zu laws, depth %u, %zu bytes, explored in %.3g s, tree in %.3g s\n",
              options.map.c_str(), toString(partition.status), map.regionCount(), map.lawCount(),
              map.cost().depth, map.bytes(), clock.seconds["explore"].get<double>(),
              clock.seconds["encode"].get<double>());
}

}  // namespace polyfly
