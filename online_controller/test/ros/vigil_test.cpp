// The thread that keeps a processor awake, as the operating system sees it.
#include "online_controller_ros/vigil.hpp"

#include <gtest/gtest.h>
#include <sched.h>

#include <fstream>
#include <limits>
#include <optional>
#include <string>

#include "named_thread.hpp"

namespace polyfly_ros {
namespace {

using Clock = Vigil::Clock;

/// Time that the thread has run [ns].
long long timeRun(pid_t thread) {
  long long time = -1;
  std::ifstream(kTasks + std::to_string(thread) + "/schedstat") >> time;
  return time;
}

/// Whether the thread waits for something, whatever else the processors have to do.
bool sleeps(pid_t thread) {
  std::ifstream file(kTasks + std::to_string(thread) + "/stat");
  file.ignore(std::numeric_limits<std::streamsize>::max(), ')');
  char state = '?';
  file >> state;
  return state == 'S';
}

/// How often the thread has gone to sleep.
long timesSlept(pid_t thread) {
  std::ifstream file(kTasks + std::to_string(thread) + "/status");
  long times = -1;
  for (std::string word; file >> word && times < 0;) {
    if (word == "voluntary_ctxt_switches:") file >> times;
  }
  return times;
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
    ASSERT_TRUE(comesTrue([this] { return sleeps(thread); }));
  }
  /// It stays awake, and has been run since.
  bool runs() const {
    const long long before = timeRun(thread);
    return comesTrue([&] { return timeRun(thread) > before + 1'000'000; }) && !sleeps(thread);
  }
  /// It was woken, and went to sleep again by itself.
  bool fallsAsleepAgain(int core, Clock::time_point until) {
    const long before = timesSlept(thread);
    vigil->keep(core, until);
    return comesTrue([&] { return timesSlept(thread) > before && sleeps(thread); });
  }
  std::optional<Vigil> vigil{std::in_place};
  pid_t thread = 0;
};

TEST_F(VigilTest, IsInNobodysWay) {
  EXPECT_TRUE(comesTrue([this] { return sched_getscheduler(thread) == SCHED_IDLE; }));
}

TEST_F(VigilTest, SleepsUntilItIsToldAndAgainFromThenOn) {
  const int core = firstCore();
  vigil->keep(core, Clock::now() + std::chrono::hours(1));
  EXPECT_TRUE(runs());
  EXPECT_TRUE(runsOnlyOn(thread, core));
  vigil->end();
  EXPECT_TRUE(comesTrue([this] { return sleeps(thread); }));
}

TEST_F(VigilTest, EndsByItself) {
  EXPECT_TRUE(fallsAsleepAgain(firstCore(), Clock::now() + std::chrono::milliseconds(1)));
  EXPECT_TRUE(fallsAsleepAgain(firstCore(), Clock::now() - std::chrono::hours(1)));
}

TEST_F(VigilTest, SleepsWhereItMayNotRun) {
  EXPECT_TRUE(fallsAsleepAgain(CPU_SETSIZE - 1, Clock::now() + std::chrono::hours(1)));
}

TEST_F(VigilTest, IsGoneWithItsOwnerAtOnce) {
  vigil->keep(firstCore(), Clock::now() + std::chrono::hours(1));
  EXPECT_TRUE(runs());
  vigil.reset();  // waits for the thread
  // The kernel may list a thread for a moment after it was joined.
  EXPECT_TRUE(comesTrue([] { return threadNamed("mpc_vigil") == 0; }));
}

}  // namespace
}  // namespace polyfly_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
