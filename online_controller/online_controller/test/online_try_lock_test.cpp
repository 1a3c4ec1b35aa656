// The lock between threads that must not wait and one that may.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <mutex>
#include <thread>

#include "online_controller/realtime/try_lock.hpp"

namespace polyfly {
namespace {

TEST(TryLock, HasOneOwnerAtATime) {
  TryLock lock;
  EXPECT_TRUE(lock.try_lock());
  EXPECT_FALSE(lock.try_lock());
  lock.unlock();
  {
    const std::lock_guard<TryLock> guard(lock);
    EXPECT_FALSE(lock.try_lock());
  }
  EXPECT_TRUE(lock.try_lock());
}

// What it guards is no atomic. Two owners at once, or one that does not see what the last one wrote, give a
// wrong sum here and a report of the thread sanitizer.
TEST(TryLock, AnOwnerSeesWhatTheLastOneWrote) {
  constexpr int kTries = 200000, kTurns = 2000;
  TryLock lock;
  long guarded = 0;
  std::array<long, 2> taken{};
  std::atomic<bool> begun{false};
  const auto hurry = [&](long& mine) {
    for (int i = 0; i < kTries || mine == 0; ++i) {
      begun = true;
      if (!lock.try_lock()) continue;
      ++mine;
      ++guarded;
      lock.unlock();
    }
  };
  std::thread first([&] { hurry(taken[0]); });
  std::thread second([&] { hurry(taken[1]); });
  while (!begun) std::this_thread::yield();
  for (int i = 0; i < kTurns; ++i) {
    const std::lock_guard<TryLock> guard(lock);
    ++guarded;
  }
  first.join();
  second.join();
  EXPECT_EQ(guarded, kTurns + taken[0] + taken[1]);
}

}  // namespace
}  // namespace polyfly
