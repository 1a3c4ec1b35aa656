// Silence by ROS time, by wall time where the clock is dead, and by neither in a paused simulation.
#include "polyfly_base/time_source.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace {

using polyfly::TimeSource;

constexpr double kPeriod = 0.01;  // [s]
constexpr double kLong = 2.0;     // [s]
constexpr double kRounding = 1e-6;

/// Wall time goes on with each call; ROS time and odometry as they are told.
struct Clocks {
  explicit Clocks(bool simulated = true) : source(simulated) {}

  void go(double seconds, bool ros_runs, bool odometry) {
    for (int k = 0; k < std::lround(seconds / kPeriod); ++k) {
      wall += kPeriod;
      if (ros_runs) ros += kPeriod;
      if (odometry) source.onOdometry(ros, wall, stamp += kPeriod);
      source.advance(ros, wall);
    }
  }

  TimeSource source;
  double ros = 0.0, wall = 5000.0, stamp = 0.0;  // [s]
};

/// Time and odometry have run for a while.
Clocks running() {
  Clocks clocks;
  clocks.ros = clocks.stamp = 100.0;
  clocks.go(kLong, true, true);
  return clocks;
}

TEST(TimeSource, RosTimeDecidesWhileItRuns) {
  Clocks clocks = running();
  EXPECT_NEAR(clocks.source.silence(), 0.0, kRounding);
  clocks.go(kLong, true, false);
  EXPECT_FALSE(clocks.source.byWall());
  EXPECT_NEAR(clocks.source.silence(), kLong, kRounding);
  EXPECT_EQ(clocks.source.ahead(), 0.0);
}

TEST(TimeSource, WallTimeDecidesWhereNoClockEverCame) {
  Clocks clocks;
  clocks.go(kLong, false, false);
  EXPECT_FALSE(clocks.source.byWall());  // there is nothing to decide on
  clocks.go(kLong, false, true);
  EXPECT_TRUE(clocks.source.byWall());
  EXPECT_NEAR(clocks.source.silence(), 0.0, kRounding);
  clocks.go(kLong, false, false);
  EXPECT_NEAR(clocks.source.silence(), kLong, kRounding);
}

TEST(TimeSource, OneOdometryIsEnoughWhereNoClockEverCame) {
  Clocks clocks;
  clocks.source.onOdometry(0.0, clocks.wall, 0.0);
  clocks.go(kLong, false, false);
  EXPECT_TRUE(clocks.source.byWall());
  EXPECT_NEAR(clocks.source.silence(), kLong, kRounding);
}

TEST(TimeSource, WallTimeDecidesWhereOdometryGoesOnAndTheClockStands) {
  Clocks clocks = running();
  clocks.go(kLong, false, true);
  EXPECT_TRUE(clocks.source.byWall());
  EXPECT_NEAR(clocks.source.silence(), 0.0, kRounding);
  clocks.go(kLong, false, false);
  EXPECT_NEAR(clocks.source.silence(), kLong, kRounding);
  EXPECT_NEAR(clocks.source.ahead(), 2.0 * kLong, 2.0 * kPeriod);
}

TEST(TimeSource, AStampThatJumpsIsNoAdvanceAndNoArrival) {
  for (const double wrong : {0.0, 2147483648.0, 4294967295.0}) {
    Clocks clocks = running();
    clocks.source.onOdometry(clocks.ros, clocks.wall, wrong);
    EXPECT_NEAR(clocks.source.arrival(), clocks.ros, TimeSource::kStandstill);
    clocks.source.onOdometry(clocks.ros, clocks.wall, clocks.stamp);
    EXPECT_NEAR(clocks.source.arrival(), clocks.ros, kPeriod);
    clocks.go(kLong, false, false);
    EXPECT_FALSE(clocks.source.byWall());  // the simulation is paused
  }
}

TEST(TimeSource, WhereTheClockIsDeadOdometryArrivesAtItsStamp) {
  Clocks clocks;
  clocks.stamp = 3e9;
  clocks.go(kLong, false, true);
  EXPECT_EQ(clocks.source.arrival(), clocks.stamp);
  Clocks later = running();
  later.go(kLong, false, true);
  EXPECT_EQ(later.source.arrival(), later.stamp);
}

TEST(TimeSource, APausedSimulationStaysPaused) {
  Clocks clocks = running();
  clocks.go(kLong, false, false);
  EXPECT_FALSE(clocks.source.byWall());
  EXPECT_LE(clocks.source.silence(), 0.0);
  // Some simulators repeat what they have while they stand.
  for (int k = 0; k < 100; ++k) clocks.source.onOdometry(clocks.ros, clocks.wall += kPeriod, clocks.stamp);
  clocks.go(kLong, false, false);
  EXPECT_FALSE(clocks.source.byWall());
  EXPECT_LE(clocks.source.silence(), 0.0);
}

TEST(TimeSource, APausedSimulationGoesOnStepByStep) {
  Clocks clocks = running();
  for (int k = 0; k < 100; ++k) {
    clocks.go(kLong, false, false);
    // The odometry of a step may be there before its clock.
    clocks.source.onOdometry(clocks.ros, clocks.wall, clocks.stamp += kPeriod);
    clocks.source.advance(clocks.ros, clocks.wall);
    EXPECT_FALSE(clocks.source.byWall());
    clocks.source.advance(clocks.ros += kPeriod, clocks.wall);
    EXPECT_NEAR(clocks.source.silence(), 0.0, kRounding);
  }
}

TEST(TimeSource, AClockSlowerThanTheOdometryIsNotDead) {
  Clocks clocks = running();
  for (int k = 0; k < 20; ++k) {
    clocks.go(0.1, false, true);
    EXPECT_FALSE(clocks.source.byWall());
    clocks.source.advance(clocks.ros += 0.1, clocks.wall);
  }
}

TEST(TimeSource, TheSilenceGoesOnWhenTheClockRunsAgain) {
  Clocks clocks = running();
  clocks.go(kLong, false, true);
  clocks.go(kLong, false, false);
  ASSERT_TRUE(clocks.source.byWall());
  clocks.go(2.0 * kPeriod, true, false);
  EXPECT_FALSE(clocks.source.byWall());
  EXPECT_NEAR(clocks.source.silence(), kLong + kPeriod, kRounding);
  clocks.go(kPeriod, true, true);
  EXPECT_LE(clocks.source.silence(), kRounding);
}

TEST(TimeSource, AClockThatJumpsWhileOdometryComesIsNoSilence) {
  Clocks late;
  late.go(kLong, false, true);
  late.source.advance(late.ros = 1.7e9, late.wall);
  EXPECT_NEAR(late.source.silence(), 0.0, kRounding);
  Clocks early;
  early.source.onOdometry(0.0, early.wall, 0.0);
  early.source.advance(early.ros = 1.7e9, early.wall);
  EXPECT_NEAR(early.source.silence(), 0.0, kRounding);
  Clocks again = running();
  again.go(kLong, false, true);
  again.source.advance(again.ros += kLong, again.wall);
  EXPECT_NEAR(again.source.silence(), 0.0, kRounding);
}

TEST(TimeSource, TimeThatBeganAnewAddsNothing) {
  Clocks clocks = running();
  clocks.go(1.0, true, false);
  clocks.ros = 10.0;
  clocks.source.advance(clocks.ros, clocks.wall);
  EXPECT_NEAR(clocks.source.silence(), 1.0, kRounding);
}

TEST(TimeSource, AClockThatLagsBehindTheOdometryIsNoSilence) {
  Clocks clocks = running();
  clocks.source.onOdometry(clocks.ros, clocks.wall, clocks.ros + 0.2);
  clocks.source.advance(clocks.ros + 0.1, clocks.wall);
  clocks.source.advance(clocks.ros + 0.2, clocks.wall);
  EXPECT_NEAR(clocks.source.silence(), 0.0, kRounding);
  clocks.source.advance(clocks.ros + 0.7, clocks.wall);
  EXPECT_NEAR(clocks.source.silence(), 0.5, kRounding);
}

TEST(TimeSource, AClockThatCatchesUpIsNoSilence) {
  for (const double offset : {0.0, 5.0, -0.05}) {  // of the stamps [s]
    // What came late is taken as of its stamp where the clock is late, too.
    const double most = 2.0 * kPeriod + std::max(-offset, 0.0);
    Clocks clocks;
    clocks.ros = 100.0;
    clocks.stamp = clocks.ros + offset;
    clocks.go(kLong, true, true);
    // A simulation that runs fast goes on while the thread of the clock waits.
    for (double lag = 0.0; lag < kLong; lag += kPeriod)
      clocks.source.onOdometry(clocks.ros, clocks.wall += 1e-4, clocks.stamp += kPeriod);
    for (double lag = kLong; lag > 0.5 * kPeriod; lag -= kPeriod) {
      clocks.source.advance(clocks.ros += kPeriod, clocks.wall += 1e-5);
      EXPECT_LE(clocks.source.silence(), most);
    }
    clocks.go(kLong, true, false);
    EXPECT_NEAR(clocks.source.silence(), kLong, most);
  }
}

TEST(TimeSource, TimeThatIsNotSimulatedAlwaysDecides) {
  Clocks clocks(false);
  clocks.source.onOdometry(7.0, clocks.wall, 3.0);
  clocks.source.advance(7.0, clocks.wall + kLong);
  EXPECT_FALSE(clocks.source.byWall());
  clocks.source.advance(7.0 + kLong, clocks.wall + kLong);
  EXPECT_NEAR(clocks.source.silence(), kLong, kRounding);
}

}  // namespace
