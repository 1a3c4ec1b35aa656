#pragma once

#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "scratch_folder.hpp"

namespace polyfly {

/// What a program printed and returned; minus the signal where one ended it.
struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// Starts a program, the first of `words`. Its standard output and error go to files of `folder`, so that
/// neither can block.
inline pid_t startProgram(std::vector<std::string> words, const std::filesystem::path& folder) {
  const pid_t child = fork();
  if (child != 0) return child;
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  if (!std::freopen((folder / "stdout").c_str(), "w", stdout) ||
      !std::freopen((folder / "stderr").c_str(), "w", stderr)) {
    _exit(126);
  }
  execv(arguments[0], arguments.data());
  _exit(127);
}

inline Outcome waitForProgram(pid_t child, const std::filesystem::path& folder) {
  int status = 0;
  waitpid(child, &status, 0);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), readBytes(folder / "stdout"),
          readBytes(folder / "stderr")};
}

}  // namespace polyfly
