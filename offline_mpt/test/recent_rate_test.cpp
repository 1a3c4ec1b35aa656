// What the progress line says of an exploration's speed.
#include <gtest/gtest.h>

#include "progress.hpp"

namespace polyfly {
namespace {

TEST(RecentRate, KnowsNothingAtFirst) {
  RecentRate rate;
  EXPECT_EQ(rate.perSecond(), 0.0);
  rate.add(1.0, 10);
  EXPECT_EQ(rate.perSecond(), 0.0);
}

TEST(RecentRate, DoesNotCountWhatACheckpointHeld) {
  RecentRate rate;
  rate.add(0.1, 100000);
  rate.add(1.1, 100050);
  EXPECT_NEAR(rate.perSecond(), 50.0, 1e-9);
}

TEST(RecentRate, ForgetsWhatIsLongAgo) {
  RecentRate rate;
  for (std::uint64_t second = 0; second <= 200; ++second)
    rate.add(static_cast<double>(second), second < 100 ? 1000 * second : 99000 + second);
  EXPECT_NEAR(rate.perSecond(), 1.0, 1e-9);
}

}  // namespace
}  // namespace polyfly
