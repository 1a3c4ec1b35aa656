#pragma once

#include <gmp.h>
#include <unistd.h>

#include <atomic>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <new>

namespace polyfly {
namespace out_of_memory {

// Exit code of every tool that could not do what it was asked.
constexpr int kExitCode = 2;
inline const char* tool = "";

/// Ends with one line and exit code 2 from any thread and any depth. Nothing is unwound: a draft of an output
/// stays behind, as from a tool that was killed.
[[noreturn]] inline void end(const char* reason) noexcept {
  static std::atomic_flag ending = ATOMIC_FLAG_INIT;
  // The others wait for the end that the first one brings.
  while (ending.test_and_set()) ::pause();
  char line[256];
  const int length = std::snprintf(line, sizeof line, "%s: %s\n", tool, reason);
  const auto shown =
      length < static_cast<int>(sizeof line) ? static_cast<std::size_t>(length) : sizeof line - 1;
  // Where even this fails, the exit code still tells.
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, line, shown);
  ::_exit(kExitCode);
}

inline void* allocate(std::size_t size) {
  void* const memory = std::malloc(size);
  if (memory == nullptr) end("out of memory");
  return memory;
}

inline void* reallocate(void* before, std::size_t, std::size_t size) {
  void* const memory = std::realloc(before, size);
  if (memory == nullptr) end("out of memory");
  return memory;
}

[[noreturn]] inline void onTerminate() {
  try {
    if (const std::exception_ptr thrown = std::current_exception()) std::rethrow_exception(thrown);
  } catch (const std::bad_alloc&) {
    end("out of memory");
  } catch (const std::exception& error) {
    end(error.what());
  } catch (...) {
  }
  std::abort();
}

}  // namespace out_of_memory

/// For the start of main of each tool that computes with GMP, whose own answer to a failed allocation is to abort.
/// Its functions are in C and must not be thrown through. A failed allocation therefore ends the tool with one line,
/// `TOOL: out of memory`, and exit code 2. So does an exception that nobody catches, as of a thread. `tool` must last
/// as long as the program. Nothing else is in this file, so that the checkers of proofs can use it.
inline void installOutOfMemoryHandler(const char* tool) {
  out_of_memory::tool = tool;
  mp_set_memory_functions(out_of_memory::allocate, out_of_memory::reallocate, nullptr);
  std::set_terminate(out_of_memory::onTerminate);
}

}  // namespace polyfly
