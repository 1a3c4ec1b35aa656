#include "command.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <thread>
#include <vector>

#include "mpi_team.hpp"
#include "region_maps/error.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {
namespace {

std::atomic<bool> stop{false};
static_assert(std::atomic<bool>::is_always_lock_free, "used in a signal handler");

extern "C" void onSignal(int) { stop.store(true); }

bool isSameFile(const std::string& a, const std::string& b) {
  struct stat first = {}, second = {};
  if (a == b) return true;
  return ::stat(a.c_str(), &first) == 0 && ::stat(b.c_str(), &second) == 0 && first.st_dev == second.st_dev &&
         first.st_ino == second.st_ino;
}

}  // namespace

const std::atomic<bool>& stopOnSignal() {
  struct sigaction action = {};
  action.sa_handler = onSignal;
  action.sa_flags = static_cast<int>(SA_RESETHAND);  // the next one has its usual effect
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  return stop;
}

void endOnSignal() {
  std::signal(SIGINT, SIG_DFL);
  std::signal(SIGTERM, SIG_DFL);
}

void ignoreSignals() {
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
}

// Processes of a launcher share the machine; one that is bound to some processors sees those only.
int defaultThreads() {
  const int all = static_cast<int>(::sysconf(_SC_NPROCESSORS_ONLN));
  const int mine = static_cast<int>(std::thread::hardware_concurrency());
  return std::clamp(std::min(mine, all / launchedHere()), 1, 256);
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

void addExploreLimits(CLI::App& command, int& threads, double& time_limit, std::uint64_t& memory_limit) {
  command.add_option("--threads", threads, "worker threads (default: all processors)")
      ->check(wholeNumber(1, 256));
  command.add_option("--time-limit", time_limit, "stop after so many seconds (default: none)")
      ->check(numberFrom(0.0));
  command
      .add_option("--memory-limit", memory_limit,
                  "stop when the exploration holds so many bytes; suffixes k, M, G (default: none)")
      ->transform(byteCount());
}

void checkWritable(const std::string& path, std::initializer_list<std::string> beside) {
  for (const std::string& other : beside) {
    if (!other.empty() && isSameFile(path, other))
      throw Error(path + ": is read or written by this command already: the output needs a name of its own");
  }
  struct stat status = {};
  if (::stat(path.c_str(), &status) == 0 && S_ISDIR(status.st_mode))
    throw Error(path + ": is a folder, not a file");
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "." : slash == 0 ? "/" : path.substr(0, slash);
  if (::access(folder.c_str(), W_OK | X_OK) != 0) {
    throw Error(path + ": folder '" + folder + "' does not exist or cannot be written");
  }
}

}  // namespace polyfly
