#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "holds.hpp"
#include "project_root.hpp"
#include "scratch_folder.hpp"

namespace polyfly {

using Words = std::vector<std::string>;

/// What a program printed and returned; minus the signal where one ended it.
struct Outcome {
  int exit_code = -1;
  std::string out;
  std::string err;
};

/// Runs the command-line tools as a user does, in a new folder. There `problems` leads to region_maps/problems.
class ToolTest : public testing::Test {
 protected:
  ToolTest() {
    std::filesystem::create_directory(work_);
    std::filesystem::create_directory_symlink(problemFile(""), path("problems"));
  }

  /// The tools may also be given a file's name alone.
  std::string path(const std::string& name) const { return work_ + "/" + name; }
  /// The name of the file.
  std::string write(const std::string& name, const std::string& text) const {
    saveText(path(name), text);
    return name;
  }
  std::string text(const std::string& name) const { return fileText(path(name)); }
  nlohmann::json json(const std::string& name) const { return nlohmann::json::parse(text(name)); }
  bool exists(const std::string& name) const { return std::filesystem::exists(path(name)); }

  /// Starts a program, the first of `words`. Its standard output and error go to files, so that neither can block.
  pid_t start(Words words) const {
    const pid_t child = fork();
    if (child != 0) return child;
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    if (chdir(work_.c_str()) != 0 || !std::freopen(folder_.file("stdout").c_str(), "w", stdout) ||
        !std::freopen(folder_.file("stderr").c_str(), "w", stderr)) {
      _exit(126);
    }
    execv(arguments[0], arguments.data());
    _exit(kNotLoaded);
  }
  Outcome wait(pid_t child) const {
    int status = 0;
    waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), fileText(folder_.file("stdout")),
            fileText(folder_.file("stderr"))};
  }

  static Words splitAtBlanks(const std::string& program, const std::string& line) {
    Words words{program};
    std::istringstream stream(line);
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
  }
  /// `offline_mpt` and `check_certificate` with the words of a line.
  Outcome run(const std::string& line) const { return wait(start(splitAtBlanks(OFFLINE_MPT_PROGRAM, line))); }
  Outcome check(const std::string& line) const { return wait(start(splitAtBlanks(CHECK_CERTIFICATE, line))); }

  /// What `offline_mpt` prints where it ends with this exit code.
  std::string output(const std::string& line, int exit_code = 0) const {
    const Outcome result = run(line);
    EXPECT_EQ(result.exit_code, exit_code) << line << "\n" << result.out << result.err;
    return result.out;
  }
  std::string complaint(const std::string& line, int exit_code) const {
    const Outcome result = run(line);
    EXPECT_EQ(result.exit_code, exit_code) << line << "\n" << result.out << result.err;
    return result.err;
  }

  /// The tool ends with exit code 2 and one line on standard error, which begins with its name and holds these parts;
  /// no file is left behind.
  void expectRefused(const Words& words, const Words& parts) const {
    const std::size_t before = fileCount();
    const Outcome result = wait(start(words));
    const std::string tool = std::filesystem::path(words[0]).filename();
    const std::string line = ::testing::PrintToString(words);
    EXPECT_EQ(result.exit_code, 2) << line << result.err;
    EXPECT_EQ(result.out, "") << line;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << line << result.err;
    EXPECT_EQ(result.err.rfind(tool + ": ", 0), 0u) << line << result.err;
    for (const std::string& part : parts) EXPECT_TRUE(holds(result.err, part)) << line;
    EXPECT_EQ(fileCount(), before) << line << "a file was left behind";
  }
  void expectRefused(const std::string& line, const Words& parts = {}) const {
    expectRefused(splitAtBlanks(OFFLINE_MPT_PROGRAM, line), parts);
  }

  std::size_t fileCount() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(work_), std::filesystem::directory_iterator()));
  }

  /// min z^2/2 - (a + b) z, |z| <= 1: three regions.
  static constexpr const char* kToy = R"({"name": "toy", "H": [[1.0]], "f": [0.0], "F": [[-1.0, -1.0]],
    "A": [[1.0], [-1.0]], "b": [1.0, 1.0], "B": [[0.0, 0.0], [0.0, 0.0]], "eq_ids": [],
    "lb": [-2.0, -2.0], "ub": [2.0, 2.0], "A_theta": [], "b_theta": [], "out": [0]})";
  /// Exit code of a program that could not be started.
  static constexpr int kNotLoaded = 127;

 private:
  ScratchFolder folder_;
  const std::string work_ = folder_.file("work");
};

}  // namespace polyfly
