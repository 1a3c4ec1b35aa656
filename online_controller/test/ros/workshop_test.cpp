// What computes long does so in a thread of less priority.
#include "online_controller_ros/workshop.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <thread>

#include "named_thread.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

int niceness() { return getpriority(PRIO_PROCESS, 0); }

TEST(Workshop, WorksElsewhereWithLessPriorityWhileTheCallerWaits) {
  const int before = niceness();
  Workshop workshop;
  for (int i = 0; i < 100; ++i) {
    std::thread::id where;
    int nice = 0;
    workshop.run([&] {
      where = std::this_thread::get_id();
      nice = niceness();
    });
    EXPECT_NE(where, std::thread::id());
    EXPECT_NE(where, std::this_thread::get_id());
    EXPECT_EQ(nice, 10);
  }
  EXPECT_EQ(niceness(), before);
}

TEST(Workshop, WhatIsThrownThereComesToTheCallerAndItGoesOn) {
  Workshop workshop;
  EXPECT_THROW(workshop.run([] { throw polyfly::Error("no"); }), polyfly::Error);
  bool done = false;
  workshop.run([&] { done = true; });
  EXPECT_TRUE(done);
}

TEST(Workshop, EndsWithoutHavingWorked) {
  {
    const Workshop workshop;
    EXPECT_NE(threadNamed("mpc_workshop"), 0);
  }
  // The kernel may list a thread for a moment after it was joined.
  EXPECT_TRUE(comesTrue([] { return threadNamed("mpc_workshop") == 0; }));
}

}  // namespace
}  // namespace polyfly_ros

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
