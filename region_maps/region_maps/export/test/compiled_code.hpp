#pragma once

#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstdlib>
#include <set>
#include <sstream>
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

inline std::string logOf(const ScratchFolder& folder) { return fileText(folder.file("log")); }

/// The rules of MISRA C that cppcheck finds broken in the folder's code.c, whose numbers are floats at most. `macros` are
/// further options of cppcheck.
inline std::set<std::string> misraDeviations(const ScratchFolder& folder, const std::string& macros = "") {
  // Cppcheck does not know the compiler's float.h, and would skip what #error guards.
  const int code = runCommand(
      folder,
      "cppcheck --addon=misra --std=c99 --platform=unix32 --enable=style --suppress=missingIncludeSystem "
      "-DFLT_RADIX=2 -DFLT_EVAL_METHOD=0 -DFLT_MANT_DIG=24 -DFLT_MAX=3.402823466e+38F -U__FAST_MATH__ " +
          macros + " code.c");
  EXPECT_EQ(code, 0) << logOf(folder);
  const std::string log = logOf(folder);
  std::set<std::string> rules;
  const std::string mark = "[misra-c2012-";
  for (std::size_t at = log.find(mark); at != std::string::npos; at = log.find(mark, at + 1)) {
    const std::size_t begin = at + mark.size();
    rules.insert(log.substr(begin, log.find(']', begin) - begin));
  }
  return rules;
}

/// That nothing deviates but what region_maps/region_maps/export/README.md lists.
inline void expectListedDeviations(const std::set<std::string>& rules, const ScratchFolder& folder) {
  // An empty list would mean that nothing was checked.
  EXPECT_EQ(rules.count("8.9"), 1u) << logOf(folder);
  for (const std::string& found : rules)
    EXPECT_TRUE((std::set<std::string>{"2.5", "8.7", "8.9"}.count(found)) != 0) << logOf(folder);
}

constexpr char kStrict[] = " -Wall -Wextra -Wconversion -pedantic -Werror -O2 -ffp-contract=off ";

constexpr char kCortexM4f[] = "arm-none-eabi-gcc -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16";
constexpr char kAtmega328p[] = "avr-gcc -mmcu=atmega328p";

/// Bytes of the sections whose names begin so, as `size -A` lists them: ".text 668 32768".
inline std::size_t sectionBytes(const std::string& sizes, const std::string& prefix) {
  std::size_t bytes = 0;
  std::istringstream lines(sizes);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string name;
    std::size_t count = 0;
    if (words >> name >> count && name.compare(0, prefix.size(), prefix) == 0) bytes += count;
  }
  return bytes;
}

/// Bytes of the instructions of the folder's code.c, without its tables, with the compiler's routines that they call.
/// `entries` are options of the linker.
inline std::size_t codeBytes(const ScratchFolder& folder, const std::string& compiler,
                             const std::string& level, const std::string& entries) {
  const std::string compile =
      compiler + " -std=c99" + kStrict + level + " -ffunction-sections -c code.c -o code.o";
  const std::string link = compiler + " -nostartfiles -nodefaultlibs -Wl,--gc-sections " + entries +
                           " code.o -lm -lc -lgcc -o code.elf";
  const std::string size = compiler.substr(0, compiler.find("gcc")) + "size -A ";
  EXPECT_EQ(runCommand(folder, compile + " && " + link + " && " + size + "code.o"), 0) << logOf(folder);
  const std::size_t tables = sectionBytes(logOf(folder), ".progmem");
  EXPECT_EQ(runCommand(folder, size + "code.elf"), 0) << logOf(folder);
  return sectionBytes(logOf(folder), ".text") - tables;
}

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
