// The baton between threads that must not wait and one that may.
#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <thread>

#include "online_controller/realtime/baton.hpp"

namespace polyfly {
namespace {

TEST(Baton, IsItsMakersUntilGivenAndNobodyGetsItTwice) {
  Baton baton;
  EXPECT_FALSE(baton.tryTake());
  baton.give();
  EXPECT_TRUE(baton.tryTake());
  EXPECT_FALSE(baton.tryTake());
  baton.give();
  {
    const BatonHold hold(&baton);
    EXPECT_FALSE(baton.tryTake());
    const BatonHold none(nullptr);
  }
  EXPECT_TRUE(baton.tryTake());
}

// What it guards is no atomic: two holders at once, or one who does not see what the last one wrote, give a
// wrong sum here and a report of the thread sanitizer.
TEST(Baton, OneHolderAtATimeSeesWhatTheLastOneDid) {
  constexpr int kTries = 200000, kTurns = 2000;
  Baton baton;
  long guarded = 0;
  std::array<long, 2> taken{};
  std::atomic<bool> begun{false};
  const auto hurry = [&](long& mine) {
    for (int i = 0; i < kTries || mine == 0; ++i) {
      begun = true;
      if (!baton.tryTake()) continue;
      ++mine;
      ++guarded;
      baton.give();
    }
  };
  std::thread first([&] { hurry(taken[0]); });
  std::thread second([&] { hurry(taken[1]); });
  while (!begun) std::this_thread::yield();
  baton.give();
  for (int i = 0; i < kTurns; ++i) {
    const BatonHold hold(&baton);
    ++guarded;
  }
  first.join();
  second.join();
  EXPECT_EQ(guarded, kTurns + taken[0] + taken[1]);
}

}  // namespace
}  // namespace polyfly
