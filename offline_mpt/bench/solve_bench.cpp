#include <algorithm>
#include <cmath>
#include <fstream>
#include <vector>

#include "bench_commands.hpp"
#include "clocks.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/explore.hpp"
#include "sample_check.hpp"

namespace polyfly::bench {
namespace {

constexpr double kShort = 1.0;   // [s] runs below it are repeated as often as asked
constexpr double kMedium = 4.0;  // [s] runs below it three times, longer ones once
constexpr double kFill = 0.02;   // [s] very short programs are solved so long at a time, and the mean counts
constexpr double kMostRepeats = 1000.0;

// Memory in use, and the most that ever was [B]; 0 where /proc is not at hand.
struct Memory {
  double now = 0.0;
  double peak = 0.0;
};

Memory memory() {
  Memory result;
  std::ifstream status("/proc/self/status");
  std::string line;
  while (std::getline(status, line)) {
    if (line.rfind("VmRSS:", 0) == 0) result.now = 1024.0 * std::stod(line.substr(6));
    if (line.rfind("VmHWM:", 0) == 0) result.peak = 1024.0 * std::stod(line.substr(6));
  }
  return result;
}

struct Run {
  double cpu = 0.0;
  double wall = 0.0;
};

// Mean of `repeats` explorations.
Run timeRun(const ParametricProgram& program, const ExploreOptions& options, int repeats,
            Partition& partition) {
  const double cpu = cpuSeconds();
  const double wall = wallSeconds();
  for (int i = 0; i < repeats; ++i) partition = explore(program, options);
  return {(cpuSeconds() - cpu) / repeats, (wallSeconds() - wall) / repeats};
}

double medianOf(std::vector<Run>& runs, double Run::*time) {
  std::sort(runs.begin(), runs.end(), [time](const Run& a, const Run& b) { return a.*time < b.*time; });
  return runs[runs.size() / 2].*time;
}

void addSamples(const SolveArguments& arguments, const ParametricProgram& program, const Partition& partition,
                Json& result) {
  if (program.text_kind != "json") return;
  std::ifstream file(arguments.problem);
  const nlohmann::json problem = nlohmann::json::parse(file);
  if (!problem.contains("samples")) return;
  const SampleCheck check = checkSamples(program, partition, problem["samples"]);
  result["feasible_samples"] = check.feasible;
  result["missed"] = check.missed;
  result["infeasible_samples"] = check.infeasible;
  result["false_inside"] = check.false_inside;
  result["u_error"] = check.u_error;
}

}  // namespace

Json solveProblem(const SolveArguments& arguments) {
  const ParametricProgram program = loadProgram(arguments.problem);
  ExploreOptions options;
  options.threads = arguments.threads;
  options.time_limit = arguments.time_limit;
  options.region_limit = ~std::uint64_t{0} >> 1;
  Partition partition;
  const Memory before = memory();
  const Run first = timeRun(program, options, 1, partition);
  // Memory of the first run only: later runs find the heap grown.
  const Memory after = memory();
  const int count = first.wall < kShort    ? arguments.runs
                    : first.wall < kMedium ? std::min(3, arguments.runs)
                                           : 1;
  const int repeats = static_cast<int>(std::min(kMostRepeats, std::ceil(kFill / std::max(first.cpu, 1e-9))));
  std::vector<Run> runs;
  if (repeats == 1) runs.push_back(first);
  while (static_cast<int>(runs.size()) < count) runs.push_back(timeRun(program, options, repeats, partition));

  Json result;
  result["problem"] = program.name;
  result["status"] = toString(partition.status);
  result["variables"] = program.variableCount();
  result["rows"] = program.rowCount();
  result["parameters"] = program.parameterCount();
  result["threads"] = arguments.threads;
  result["regions"] = partition.regions.size();
  result["wall_seconds"] = medianOf(runs, &Run::wall);
  result["cpu_seconds"] = medianOf(runs, &Run::cpu);
  result["cpu_least"] = runs.front().cpu;
  result["cpu_greatest"] = runs.back().cpu;
  result["runs"] = runs.size();
  result["peak_bytes"] = std::max(0.0, after.peak - before.now);
  addSamples(arguments, program, partition, result);
  return result;
}

}  // namespace polyfly::bench
