#include "command.hpp"

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstring>
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

void writeText(const std::string& path, const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  writeFileAtomically(path, bytes);
}

void checkWritable(const std::string& path) {
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
