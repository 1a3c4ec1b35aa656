#pragma once

#include <dirent.h>
#include <sys/types.h>

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>

namespace polyfly_ros {

inline const std::string kTasks = "/proc/self/task/";

/// The thread of that name in this process, 0: none.
inline pid_t threadNamed(const std::string& name) {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir(kTasks.c_str()), closedir);
  while (const dirent* entry = readdir(folder.get())) {
    std::string found;
    std::getline(std::ifstream(kTasks + entry->d_name + "/comm"), found);
    if (found == name) return std::atoi(entry->d_name);
  }
  return 0;
}

/// Whether it comes true at all: a busy machine may not run a thread for long, so a test says nothing of
/// when.
inline bool comesTrue(const std::function<bool()>& condition) {
  constexpr std::chrono::seconds kLongest{20};
  for (const auto end = std::chrono::steady_clock::now() + kLongest;
       std::chrono::steady_clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

}  // namespace polyfly_ros
