#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <string>

#include "scratch_folder.hpp"

namespace polyfly {

inline bool hasProgram(const std::string& name) {
  return std::system(("command -v " + name + " > /dev/null 2>&1").c_str()) == 0;
}

/// The command's exit code; its output goes to `folder`/log.
inline int runCommand(const ScratchFolder& folder, const std::string& command) {
  const int status = std::system(("cd " + folder.file(".") + " && " + command + " > log 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

inline std::string logOf(const ScratchFolder& folder) {
  std::ifstream in(folder.file("log"));
  return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
}

inline void saveText(const ScratchFolder& folder, const std::string& name, const std::string& text) {
  std::ofstream(folder.file(name)) << text;
}

constexpr char kStrict[] = " -Wall -Wextra -Wconversion -pedantic -Werror -O2 -ffp-contract=off ";

/// Exported code, compiled to a shared library and loaded.
template <class Real>
class CompiledCode {
 public:
  /// NAME.c and NAME.h are in the folder.
  CompiledCode(const ScratchFolder& folder, const std::string& name, const std::string& compiler) {
    const std::string library = name + ".so";
    const int code = runCommand(folder, compiler + kStrict + "-shared -fPIC " + name + ".c -o " + library);
    EXPECT_EQ(code, 0) << logOf(folder);
    handle_ = ::dlopen(folder.file(library).c_str(), RTLD_NOW | RTLD_LOCAL);
    if (handle_ == nullptr) throw std::runtime_error(::dlerror());
    evaluate = reinterpret_cast<Evaluate>(::dlsym(handle_, (name + "_evaluate").c_str()));
    locate = reinterpret_cast<Locate>(::dlsym(handle_, (name + "_locate").c_str()));
  }
  CompiledCode(const CompiledCode&) = delete;
  CompiledCode& operator=(const CompiledCode&) = delete;
  ~CompiledCode() { ::dlclose(handle_); }

  using Evaluate = int (*)(const Real* theta, Real* u);
  using Locate = int (*)(const Real* theta, std::uint32_t* region);
  Evaluate evaluate = nullptr;
  Locate locate = nullptr;

 private:
  void* handle_ = nullptr;
};

}  // namespace polyfly
