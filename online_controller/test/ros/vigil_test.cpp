// The thread that keeps a processor awake, as the operating system sees it.
#include "online_controller_ros/vigil.hpp"

#include <dirent.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/types.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>

namespace polyfly_ros {
namespace {

using Clock = Vigil::Clock;
constexpr std::chrono::seconds kPatience{20};  // a busy machine may not run such a thread for long
constexpr std::chrono::milliseconds kAWhile{30};

const std::string kTasks = "/proc/self/task/";

/// The thread of that name in this process, 0: none.
pid_t threadNamed(const std::string& name) {
  const std::unique_ptr<DIR, int (*)(DIR*)> folder(opendir(kTasks.c_str()), closedir);
  while (const dirent* entry = readdir(folder.get())) {
    std::string found;
    std::getline(std::ifstream(kTasks + entry->d_name + "/comm"), found);
    if (found == name) return std::atoi(entry->d_name);
  }
  return 0;
}

/// Time that the thread has run [ns].
long long timeRun(pid_t thread) {
  long long time = -1;
  std::ifstream(kTasks + std::to_string(thread) + "/schedstat") >> time;
  return time;
}

bool comesTrue(const std::function<bool()>& condition) {
  for (const auto end = Clock::now() + kPatience; Clock::now() < end;) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

int firstCore() {
  cpu_set_t cores;
  sched_getaffinity(0, sizeof cores, &cores);
  int core = 0;
  while (!CPU_ISSET(static_cast<std::size_t>(core), &cores)) ++core;
  return core;
}

bool runsOnlyOn(pid_t thread, int core) {
  cpu_set_t cores;
  sched_getaffinity(thread, sizeof cores, &cores);
  return CPU_COUNT(&cores) == 1 && CPU_ISSET(static_cast<std::size_t>(core), &cores);
}

struct VigilTest : testing::Test {
  void SetUp() override {
    ASSERT_TRUE(comesTrue([this] { return (thread = threadNamed("mpc_vigil")) != 0; }));
  }
  bool runs() const {
    const long long before = timeRun(thread);
    std::this_thread::sleep_for(kAWhile);
    return timeRun(thread) > before + 1'000'000;
  }
  Vigil vigil;
  pid_t thread = 0;
};

TEST_F(VigilTest, IsInNobodysWay) {
  EXPECT_TRUE(comesTrue([this] { return sched_getscheduler(thread) == SCHED_IDLE; }));
}

TEST_F(VigilTest, SleepsUntilItIsToldAndAgainFromThenOn) {
  EXPECT_TRUE(comesTrue([this] { return !runs(); }));
  const int core = firstCore();
  vigil.keep(core, Clock::now() + std::chrono::hours(1));
  EXPECT_TRUE(comesTrue([this] { return runs(); }));
  EXPECT_TRUE(runsOnlyOn(thread, core));
  vigil.end();
  EXPECT_TRUE(comesTrue([this] { return !runs(); }));
}

TEST_F(VigilTest, EndsByItself) {
  vigil.keep(firstCore(), Clock::now() + std::chrono::milliseconds(1));
  EXPECT_TRUE(comesTrue([this] { return !runs(); }));
  vigil.keep(firstCore(), Clock::now() - std::chrono::hours(1));
  EXPECT_FALSE(runs());
}

TEST_F(VigilTest, SleepsWhereItMayNotRun) {
  vigil.keep(CPU_SETSIZE - 1, Clock::now() + std::chrono::hours(1));
  EXPECT_FALSE(runs());
}

TEST_F(VigilTest, IsGoneWithItsOwnerAtOnce) { vigil.keep(firstCore(), Clock::now() + std::chrono::hours(1)); }

}  // namespace
}  // namespace polyfly_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
