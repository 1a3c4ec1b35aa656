#include "command.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <thread>
#include <utility>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "mpi_group.hpp"
#include "polyfly_base/write_file.hpp"

namespace polyfly {

namespace {

// So many slacks of one bound are told of.
constexpr int kManySlacks = 5;

/// Each slack may be at its floor or not, in each region anew.
std::vector<std::string> remarksOnSlacks(const ParametricProgram& program) {
  std::map<std::string, int> counts;
  for (const SlackVariable& slack : program.slacks) ++counts[slack.name];
  std::vector<std::string> remarks;
  for (const auto& [name, count] : counts) {
    if (count < kManySlacks) continue;
    remarks.push_back(
        "the soft bound " + name + " has " + std::to_string(count) +
        " slacks, which may multiply the regions; one for all stages ('slack: horizon') adds few, and "
        "fewer stages or blocked moves help");
  }
  return remarks;
}

}  // namespace

// Processes of a launcher share the machine; one that is bound to some processors sees those only.
int defaultThreads() {
  const int all = static_cast<int>(::sysconf(_SC_NPROCESSORS_ONLN));
  const int mine = static_cast<int>(std::thread::hardware_concurrency());
  return std::clamp(std::min(mine, all / launchedHere()), 1, 256);
}

void printRemarks(const std::string& problem, const ParametricProgram& program) {
  std::vector<std::string> remarks = program.remarks;
  for (std::string& remark : remarksOnSlacks(program)) remarks.push_back(std::move(remark));
  for (const std::string& remark : remarks)
    std::fprintf(stderr, "offline_mpt: %s: %s\n", problem.c_str(), remark.c_str());
}

Error namingFile(const Error& error, const ParametricProgram& program, const std::string& file) {
  const std::string text = error.what(), name = program.name + ": ";
  return text.compare(0, name.size(), name) == 0 ? Error(file + ": " + text.substr(name.size())) : error;
}

void writeText(const std::string& path, const std::string& text) { writeFileAtomically(path, text); }

ExitCode exitCode(ExploreStatus status) {
  switch (status) {
    case ExploreStatus::kComplete:
      return ExitCode::kDone;
    case ExploreStatus::kIncomplete:
    case ExploreStatus::kUnbounded:
      return ExitCode::kFailed;
    case ExploreStatus::kLimited:
    case ExploreStatus::kInterrupted:
      return ExitCode::kStopped;
    case ExploreStatus::kInfeasible:
      return ExitCode::kBadInput;
  }
  return ExitCode::kBadInput;
}

void addThreads(CLI::App& command, int& threads) {
  threads = defaultThreads();
  command.add_option("--threads", threads, "Number of worker threads (default: all processors).")
      ->check(wholeNumber(1, 256));
}

void addTimeLimit(CLI::App& command, double& time_limit) {
  command.add_option("--time-limit", time_limit, "Stop after this many seconds (default: no limit).")
      ->check(numberFrom(0.0));
}

}  // namespace polyfly
