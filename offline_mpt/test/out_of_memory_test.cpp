// Memory that runs out ends a tool with one line and exit code 2, in GMP and in threads too.
#include "polyfly_base/out_of_memory.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "run_program.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

// More than any allocator gives.
constexpr std::size_t kTooMuch = PTRDIFF_MAX;

void allocateInGmp() {
  installOutOfMemoryHandler("tool");
  void* (*allocate)(std::size_t) = nullptr;
  mp_get_memory_functions(&allocate, nullptr, nullptr);
  allocate(kTooMuch);
}

void reallocateInGmp() {
  installOutOfMemoryHandler("tool");
  void* (*allocate)(std::size_t) = nullptr;
  void* (*reallocate)(void*, std::size_t, std::size_t) = nullptr;
  mp_get_memory_functions(&allocate, &reallocate, nullptr);
  reallocate(allocate(8), 8, kTooMuch);
}

template <class Thrown>
void throwInAThread(const Thrown& thrown) {
  installOutOfMemoryHandler("tool");
  std::thread([&thrown] { throw Thrown(thrown); }).join();
}

TEST(OutOfMemoryDeathTest, OfGmpIsOneLine) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer's allocator ends the program itself";
#endif
  EXPECT_EXIT(allocateInGmp(), testing::ExitedWithCode(2), "^tool: out of memory\n$");
  EXPECT_EXIT(reallocateInGmp(), testing::ExitedWithCode(2), "^tool: out of memory\n$");
}

TEST(OutOfMemoryDeathTest, OfAThreadIsOneLine) {
  EXPECT_EXIT(throwInAThread(std::bad_alloc()), testing::ExitedWithCode(2), "^tool: out of memory\n$");
  EXPECT_EXIT(throwInAThread(std::runtime_error("no thread")), testing::ExitedWithCode(2),
              "^tool: no thread\n$");
}

TEST(OutOfMemory, OfAWorkerComesToTheCaller) {
  const auto fail = [](std::size_t, std::uint64_t i) {
    if (i == 5) throw std::bad_alloc();
  };
  EXPECT_THROW(inParallel(10, 3, nullptr, {}, fail), std::bad_alloc);
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// Programs that may take so little memory, from what does to load them up to more than they need.
class LittleMemory : public ToolTest {
 protected:
  void SetUp() override {
    getrlimit(RLIMIT_AS, &before_);
    write("toy.json", kToy);
    output("solve toy.json -o toy.map");
    output("verify toy.map --exact --certificate proof");
  }

  // Done, or out of memory in one line. A program that could not be loaded is none that ran.
  void expectAnswers(const std::string& program, const std::string& line) const {
    const std::string tool = std::filesystem::path(program).filename();
    bool done = false;
    for (rlim_t megabytes = 16; megabytes <= 1024; megabytes += megabytes / 4) {
      rlimit limit = before_;
      limit.rlim_cur = megabytes << 20U;
      setrlimit(RLIMIT_AS, &limit);
      const pid_t child = start(splitAtBlanks(program, line));
      setrlimit(RLIMIT_AS, &before_);
      const Outcome result = wait(child);
      if (result.exit_code == kNotLoaded) continue;
      done = result.exit_code == 0;
      if (done) continue;
      EXPECT_EQ(result.exit_code, 2) << megabytes << " MiB: " << result.err;
      EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1)
          << megabytes << " MiB: " << result.err;
      EXPECT_EQ(result.err.rfind(tool + ": ", 0), 0u) << megabytes << " MiB: " << result.err;
    }
    EXPECT_TRUE(done);
  }

  rlimit before_{};
};

TEST_F(LittleMemory, EndsTheSolverAndItsVerificationInWords) {
  // A run that ends in the tree leaves a checkpoint.
  expectAnswers(OFFLINE_MPT_PROGRAM, "solve toy.json -o again.map --quiet --threads 4 --force");
  expectAnswers(OFFLINE_MPT_PROGRAM, "verify toy.map --exact --threads 4");
}

TEST_F(LittleMemory, EndsTheCheckerInWords) { expectAnswers(CHECK_CERTIFICATE, "proof --map toy.map"); }
#endif

}  // namespace
}  // namespace polyfly
