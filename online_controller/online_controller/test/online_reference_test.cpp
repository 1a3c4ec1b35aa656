#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "online_controller/reference/reference_schedule.hpp"
#include "polyfly_base/error.hpp"

namespace {

using polyfly::Error;
using polyfly::Reference;
using polyfly::ReferenceSchedule;
using polyfly::ReferenceTrajectory;
using polyfly::TrajectorySample;

constexpr double kPi = 3.14159265358979323846;

TrajectorySample at(double time, const Eigen::Vector3d& position, double yaw = 0.0) {
  TrajectorySample sample;
  sample.time = time;
  sample.position = position;
  sample.yaw = yaw;
  return sample;
}

/// A quintic in each axis and its derivatives, as an oracle.
double quintic(double t) { return 1.0 + t * (-2.0 + t * (0.5 + t * (0.3 + t * (-0.2 + t * 0.04)))); }
double quintic1(double t) { return -2.0 + t * (1.0 + t * (0.9 + t * (-0.8 + t * 0.2))); }
double quintic2(double t) { return 1.0 + t * (1.8 + t * (-2.4 + t * 0.8)); }
double quintic3(double t) { return 1.8 + t * (-4.8 + t * 2.4); }

TrajectorySample onQuintic(double t) {
  TrajectorySample sample = at(t, {quintic(t), 2.0 * quintic(t), -quintic(t)}, 0.1 * t);
  sample.has_velocity = sample.has_acceleration = true;
  sample.velocity = Eigen::Vector3d(1.0, 2.0, -1.0) * quintic1(t);
  sample.acceleration = Eigen::Vector3d(1.0, 2.0, -1.0) * quintic2(t);
  sample.yaw_rate = 0.1;
  return sample;
}

std::string refusal(std::vector<TrajectorySample> samples) {
  try {
    const ReferenceTrajectory refused(std::move(samples));
    return {};
  } catch (const polyfly::Error& error) {
    return error.what();
  }
}

TEST(ReferenceTrajectory, ReproducesAQuinticWithAllItsDerivatives) {
  const ReferenceTrajectory trajectory({onQuintic(-1.0), onQuintic(0.3), onQuintic(2.0)});
  for (int i = 0; i <= 300; ++i) {
    const double t = -1.0 + 0.01 * i;
    const Reference reference = trajectory.sample(t);
    const Eigen::Vector3d direction(1.0, 2.0, -1.0);
    EXPECT_LT((reference.position - direction * quintic(t)).norm(), 1e-11) << t;
    EXPECT_LT((reference.velocity - direction * quintic1(t)).norm(), 1e-10) << t;
    EXPECT_LT((reference.acceleration - direction * quintic2(t)).norm(), 1e-9) << t;
    EXPECT_LT((reference.jerk - direction * quintic3(t)).norm(), 1e-8) << t;
    EXPECT_NEAR(reference.yaw, 0.1 * t, 1e-12);
    EXPECT_NEAR(reference.yaw_rate, 0.1, 1e-12);
  }
}

TEST(ReferenceTrajectory, HoldsFirstAndLastPoseAtRest) {
  const ReferenceTrajectory trajectory({onQuintic(0.0), onQuintic(1.0)});
  for (const double t : {-1e9, -1e-9}) {
    const Reference before = trajectory.sample(t);
    EXPECT_EQ(before.position, onQuintic(0.0).position);
    EXPECT_EQ(before.velocity, Eigen::Vector3d::Zero());
    EXPECT_EQ(before.acceleration, Eigen::Vector3d::Zero());
    EXPECT_EQ(before.yaw_rate, 0.0);
  }
  for (const double t : {1.0 + 1e-9, 1e9}) {
    const Reference after = trajectory.sample(t);
    EXPECT_EQ(after.position, onQuintic(1.0).position);
    EXPECT_EQ(after.velocity, Eigen::Vector3d::Zero());
    EXPECT_EQ(after.jerk, Eigen::Vector3d::Zero());
  }
  const Reference nan = trajectory.sample(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(nan.position, onQuintic(0.0).position);
}

TEST(ReferenceTrajectory, DerivesWhatIsMissing) {
  // Position only, unevenly sampled, of constant acceleration: differences by parabolas are exact inside.
  std::vector<TrajectorySample> samples;
  for (const double t : {0.0, 0.2, 0.5, 0.6, 1.0, 1.5})
    samples.push_back(at(t, {3.0 * t, 0.5 * t * t, 1.0}, 0.4 * t));
  const ReferenceTrajectory trajectory(samples);
  for (std::size_t i = 1; i + 1 < samples.size(); ++i) {
    const double t = samples[i].time;
    const Reference reference = trajectory.sample(t);
    EXPECT_NEAR(reference.velocity.x(), 3.0, 1e-12);
    EXPECT_NEAR(reference.velocity.y(), t, 1e-12);
    EXPECT_NEAR(reference.velocity.z(), 0.0, 1e-12);
    EXPECT_NEAR(reference.yaw_rate, 0.4, 1e-12);
  }
  // Two neighbours away from the ends, the velocities are exact and so are the accelerations.
  EXPECT_NEAR(trajectory.sample(0.5).acceleration.y(), 1.0, 1e-12);
  EXPECT_NEAR(trajectory.sample(0.6).acceleration.y(), 1.0, 1e-12);
  EXPECT_NEAR(trajectory.sample(0.55).position.y(), 0.5 * 0.55 * 0.55, 1e-12);
}

/// Values of a sine of amplitude 0.75 m and its derivatives: an oracle.
TrajectorySample onSine(double t) {
  TrajectorySample sample = at(t, {0.75 * std::sin(1.8 * t), 0.0, 1.0}, 0.3 * std::sin(t));
  sample.velocity.x() = 0.75 * 1.8 * std::cos(1.8 * t);
  sample.acceleration.x() = -0.75 * 1.8 * 1.8 * std::sin(1.8 * t);
  sample.yaw_rate = 0.3 * std::cos(t);
  return sample;
}

/// Greatest errors of the reference over what lies `margin` s within the ends.
struct SineErrors {
  double velocity = 0.0, acceleration = 0.0, jerk = 0.0, yaw_rate = 0.0;
};
SineErrors errorsOf(const ReferenceTrajectory& trajectory, double margin) {
  SineErrors most;
  for (double t = trajectory.startTime() + margin; t < trajectory.endTime() - margin; t += 0.0037) {
    const Reference reference = trajectory.sample(t);
    const double jerk = -0.75 * 1.8 * 1.8 * 1.8 * std::cos(1.8 * t);
    most.velocity = std::max(most.velocity, std::abs(reference.velocity.x() - onSine(t).velocity.x()));
    most.acceleration =
        std::max(most.acceleration, std::abs(reference.acceleration.x() - onSine(t).acceleration.x()));
    most.jerk = std::max(most.jerk, std::abs(reference.jerk.x() - jerk));
    most.yaw_rate = std::max(most.yaw_rate, std::abs(reference.yaw_rate - onSine(t).yaw_rate));
  }
  return most;
}

TEST(ReferenceTrajectory, PositionsAloneGiveTheJerkOfThePath) {
  // The laws lead the lag of the attitude by the jerk: one that is wrong shakes the vehicle.
  for (const double step : {0.01, 0.05, 0.1}) {
    std::vector<TrajectorySample> samples;
    for (int i = 0; i * step < 8.0; ++i) samples.push_back(onSine(i * step));
    const SineErrors most = errorsOf(ReferenceTrajectory(samples), 1.0);
    // A cubic spline's error falls with the fourth power of the step in the value, and by one less per
    // derivative: with p = 7.9 m/s^4 at most h p/2 in the jerk.
    EXPECT_LT(most.jerk, 0.5 * step * 7.9) << step;
    EXPECT_LT(most.acceleration, step * step * 7.9) << step;
    EXPECT_LT(most.velocity, step * step * step * 7.9) << step;
    EXPECT_LT(most.yaw_rate, step * step * step) << step;
  }
}

TEST(ReferenceTrajectory, GivenVelocitiesHoldWhereOthersAreComputed) {
  std::vector<TrajectorySample> samples;
  for (int i = 0; i <= 80; ++i) {
    samples.push_back(onSine(0.1 * i));
    samples.back().has_velocity = i % 7 == 3 || i % 7 == 5 || i == 0 || i == 80;
  }
  const ReferenceTrajectory trajectory(samples);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (samples[i].has_velocity) {
      EXPECT_EQ(trajectory.samples()[i].velocity, samples[i].velocity) << i;
    }
  }
  const SineErrors most = errorsOf(trajectory, 0.01);
  EXPECT_LT(most.velocity, 0.005);
  // The jerk itself reaches 4.4 m/s^3.
  EXPECT_LT(most.jerk, 0.5);
}

TEST(ReferenceTrajectory, TwoAndThreePositionsGiveALineAndAParabola) {
  const ReferenceTrajectory line({at(1.0, {0, 0, 0}), at(3.0, {4, 0, 0})});
  EXPECT_NEAR(line.sample(1.7).velocity.x(), 2.0, 1e-12);
  EXPECT_NEAR(line.sample(1.7).acceleration.x(), 0.0, 1e-12);
  const ReferenceTrajectory parabola({at(0.0, {0, 0, 0}), at(1.0, {1, 0, 0}), at(3.0, {9, 0, 0})});
  for (const double t : {0.0, 0.4, 1.0, 2.5, 3.0}) {
    EXPECT_NEAR(parabola.sample(t).position.x(), t * t, 1e-12) << t;
    EXPECT_NEAR(parabola.sample(t).velocity.x(), 2.0 * t, 1e-12) << t;
    EXPECT_NEAR(parabola.sample(t).jerk.x(), 0.0, 1e-10) << t;
  }
}

TEST(ReferenceTrajectory, AccelerationIsContinuousWithDerivedData) {
  std::vector<TrajectorySample> samples;
  samples.reserve(20);
  for (int i = 0; i < 20; ++i) samples.push_back(at(0.1 * i, {std::sin(0.3 * i), 0.0, 0.0}));
  const ReferenceTrajectory trajectory(samples);
  constexpr double kStep = 1e-9;
  for (int i = 1; i < 19; ++i) {
    const double t = samples[static_cast<std::size_t>(i)].time;
    EXPECT_LT((trajectory.sample(t + kStep).acceleration - trajectory.sample(t - kStep).acceleration).norm(),
              1e-3);
  }
}

TEST(ReferenceTrajectory, YawTakesTheShorterWay) {
  const ReferenceTrajectory trajectory({at(0.0, {0, 0, 0}, 3.0), at(1.0, {0, 0, 0}, -3.0)});
  const Reference middle = trajectory.sample(0.5);
  EXPECT_NEAR(std::abs(middle.yaw), kPi, 1e-9);
  EXPECT_NEAR(middle.yaw_rate, 2.0 * kPi - 6.0, 1e-9);
  EXPECT_NEAR(trajectory.sample(1.0).yaw, -3.0, 1e-9);
}

TEST(ReferenceTrajectory, PoseIsHeldForEver) {
  const ReferenceTrajectory pose = ReferenceTrajectory::pose({1.0, 2.0, 3.0}, 0.5);
  for (const double t : {-1e6, 0.0, 1e6}) {
    const Reference reference = pose.sample(t);
    EXPECT_EQ(reference.position, Eigen::Vector3d(1.0, 2.0, 3.0));
    EXPECT_EQ(reference.velocity, Eigen::Vector3d::Zero());
    EXPECT_EQ(reference.yaw, 0.5);
  }
}

TEST(ReferenceTrajectory, SingleSampleIsAPose) {
  TrajectorySample sample = onQuintic(0.0);
  const ReferenceTrajectory trajectory({sample});
  EXPECT_EQ(trajectory.sample(0.0).velocity, Eigen::Vector3d::Zero());
}

TEST(ReferenceTrajectory, RefusesBadSamples) {
  EXPECT_NE(refusal({}).find("at least one"), std::string::npos);
  EXPECT_NE(refusal({at(0.0, {0, 0, 0}), at(0.0, {1, 0, 0})}).find("sample 1: time"), std::string::npos);
  EXPECT_NE(refusal({at(1.0, {0, 0, 0}), at(0.5, {1, 0, 0})}).find("sample 1: time"), std::string::npos);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refusal({at(0.0, {0, nan, 0})}).find("sample 0"), std::string::npos);
  EXPECT_NE(refusal({at(nan, {0, 0, 0})}).find("finite"), std::string::npos);
  EXPECT_NE(refusal({at(0.0, {1e7, 0, 0})}).find("1e6"), std::string::npos);
  EXPECT_NE(refusal({at(0.0, {0, 0, 0}, nan)}).find("finite"), std::string::npos);
  const std::vector<TrajectorySample> many(ReferenceTrajectory::kMaxSamples + 1);
  EXPECT_NE(refusal(many).find("at most"), std::string::npos);
}

TEST(ReferenceSchedule, NothingBeforeTheFirst) {
  ReferenceSchedule schedule;
  EXPECT_FALSE(schedule.sample(0.0));
  schedule.set(ReferenceTrajectory(), 0.0);
  EXPECT_FALSE(schedule.sample(0.0));
}

TEST(ReferenceSchedule, TimesCountFromTheStart) {
  ReferenceSchedule schedule;
  schedule.set(ReferenceTrajectory({onQuintic(0.0), onQuintic(1.0)}), 100.0);
  EXPECT_EQ(schedule.sample(99.0)->position, onQuintic(0.0).position);
  EXPECT_NEAR(schedule.sample(100.5)->position.x(), quintic(0.5), 1e-12);
}

TEST(ReferenceSchedule, WithoutAStartItStartsWithTheNextSample) {
  ReferenceSchedule schedule;
  schedule.set(ReferenceTrajectory({onQuintic(0.0), onQuintic(1.0)}), std::nullopt);
  EXPECT_NEAR(schedule.sample(50.0)->position.x(), quintic(0.0), 1e-12);
  EXPECT_NEAR(schedule.sample(50.25)->position.x(), quintic(0.25), 1e-12);
  schedule.set(ReferenceTrajectory::pose({7, 8, 9}, 0.0), std::nullopt);
  EXPECT_EQ(schedule.sample(50.26)->position.x(), 7.0);
}

TEST(ReferenceSchedule, ALaterTrajectoryWaitsForItsStart) {
  ReferenceSchedule schedule;
  schedule.set(ReferenceTrajectory::pose({1, 0, 0}, 0.0), 0.0);
  EXPECT_EQ(schedule.sample(1.0)->position.x(), 1.0);
  schedule.set(ReferenceTrajectory::pose({2, 0, 0}, 0.0), 2.0);
  EXPECT_EQ(schedule.sample(1.9)->position.x(), 1.0);
  schedule.set(ReferenceTrajectory::pose({3, 0, 0}, 0.0), 3.0);
  EXPECT_EQ(schedule.sample(2.5)->position.x(), 2.0);
  EXPECT_EQ(schedule.sample(3.0)->position.x(), 3.0);
  EXPECT_EQ(schedule.sample(9.0)->position.x(), 3.0);
}

TEST(ReferenceSchedule, PreviewSeesTheTrajectoryThatWaits) {
  ReferenceSchedule schedule;
  std::array<Reference, 4> ahead;
  EXPECT_FALSE(schedule.preview(0.0, 0.5, 4, ahead.data()));
  schedule.set(ReferenceTrajectory({onQuintic(0.0), onQuintic(1.0)}), 10.0);
  schedule.set(ReferenceTrajectory::pose({7, 0, 0}, 0.0), 11.0);
  ASSERT_TRUE(schedule.preview(10.25, 0.5, 4, ahead.data()));
  EXPECT_NEAR(ahead[0].position.x(), quintic(0.25), 1e-12);
  EXPECT_NEAR(ahead[1].position.x(), quintic(0.75), 1e-12);
  EXPECT_EQ(ahead[2].position.x(), 7.0);
  EXPECT_EQ(ahead[3].position.x(), 7.0);
  EXPECT_NEAR(schedule.sample(10.5)->position.x(), quintic(0.5), 1e-12);  // it waits still
}

/// A line at 1 m/s along x from `x`, points every 0.1 s.
ReferenceTrajectory lineFrom(double x, int points, double y = 0.0) {
  std::vector<TrajectorySample> samples;
  for (int i = 0; i < points; ++i) {
    TrajectorySample sample = at(0.1 * i, {x + 0.1 * i, y, 0});
    sample.velocity.x() = 1.0;
    sample.has_velocity = sample.has_acceleration = true;
    samples.push_back(sample);
  }
  return ReferenceTrajectory(std::move(samples));
}

TEST(ReferenceSchedule, OneThatStartsWithinTheOldReplacesItFromThereOn) {
  ReferenceSchedule schedule;
  schedule.set(lineFrom(0.0, 21), 10.0);
  schedule.set(lineFrom(100.0, 6), 11.05);
  for (const double t : {10.0, 10.33, 11.02, 11.049}) {
    // The old trajectory counts until the new one starts.
    EXPECT_NEAR(schedule.sample(t)->position.x(), t - 10.0, 1e-9) << t;
    EXPECT_NEAR(schedule.sample(t)->velocity.x(), 1.0, 1e-9) << t;
  }
  EXPECT_NEAR(schedule.sample(11.05)->position.x(), 100.0, 1e-9);
  EXPECT_NEAR(schedule.sample(11.25)->position.x(), 100.2, 1e-9);
  EXPECT_FALSE(schedule.ended(11.5));
  EXPECT_TRUE(schedule.ended(11.6));
  EXPECT_NEAR(schedule.sample(11.7)->position.x(), 100.5, 1e-9);
  EXPECT_EQ(schedule.sample(11.7)->velocity.x(), 0.0);
}

TEST(ReferenceSchedule, PiecesFollowEachOtherWithoutASeam) {
  // A line in pieces of five points, each with its own stamp and sent ahead, as planners stream it.
  ReferenceSchedule schedule;
  for (int piece = 0; piece < 4; ++piece) schedule.set(lineFrom(0.5 * piece, 5), 10.0 + 0.5 * piece);
  for (int k = 0; k < 190; ++k) {
    const double t = 10.0 + 0.01 * k;
    EXPECT_NEAR(schedule.sample(t)->position.x(), 0.01 * k, 1e-9) << k;
    EXPECT_NEAR(schedule.sample(t)->velocity.x(), 1.0, 1e-7) << k;
  }
}

TEST(ReferenceSchedule, AfterALongGapTheLastPointIsHeldUntilTheNext) {
  ReferenceSchedule schedule;
  schedule.set(lineFrom(0.0, 11), 10.0);
  schedule.set(lineFrom(5.0, 11), 12.0);
  EXPECT_EQ(schedule.sample(11.5)->position.x(), 1.0);
  EXPECT_EQ(schedule.sample(11.5)->velocity.x(), 0.0);
  EXPECT_FALSE(schedule.ended(11.5));
  EXPECT_EQ(schedule.sample(12.0)->position.x(), 5.0);
}

TEST(ReferenceSchedule, ALateOneDropsWhatWasToComeAfterIt) {
  ReferenceSchedule schedule;
  schedule.set(lineFrom(0.0, 11), 10.0);
  schedule.set(lineFrom(5.0, 11), 11.0);
  schedule.set(lineFrom(7.0, 11), 12.0);
  schedule.set(lineFrom(9.0, 11), 10.5);
  EXPECT_NEAR(schedule.sample(10.4)->position.x(), 0.4, 1e-9);
  EXPECT_NEAR(schedule.sample(11.0)->position.x(), 9.5, 1e-9);
  EXPECT_NEAR(schedule.sample(12.5)->position.x(), 10.0, 1e-9);
}

TEST(ReferenceSchedule, AStampThatIsPastIsEnteredOnTheWay) {
  ReferenceSchedule schedule;
  schedule.set(lineFrom(0.0, 101), 10.0);
  EXPECT_NEAR(schedule.sample(12.0)->position.x(), 2.0, 1e-9);
  schedule.set(lineFrom(50.0, 101), 11.0);
  EXPECT_NEAR(schedule.sample(12.0)->position.x(), 51.0, 1e-9);
}

TEST(ReferenceSchedule, WaitsForAsManyAsItHasRoomFor) {
  ReferenceSchedule schedule;
  for (std::size_t i = 0; i < ReferenceSchedule::kMaxEntries; ++i) {
    schedule.set(lineFrom(0.0, 5), 10.0 + static_cast<double>(i));
  }
  EXPECT_THROW(schedule.set(lineFrom(0.0, 5), 1000.0), Error);
  EXPECT_NEAR(schedule.sample(20.25)->position.x(), 0.25, 1e-9);
  schedule.set(lineFrom(3.0, 5), 1000.0);  // ten are over
  EXPECT_NEAR(schedule.sample(1000.25)->position.x(), 3.25, 1e-9);
}

TEST(ReferenceSchedule, HoldEndsEverything) {
  ReferenceSchedule schedule;
  schedule.hold({1, 2, 3}, 0.5);
  EXPECT_EQ(schedule.sample(5.0)->position.y(), 2.0);
  schedule.set(lineFrom(0.0, 11), 10.0);
  schedule.set(lineFrom(0.0, 11), 12.0);
  EXPECT_EQ(schedule.sample(9.0)->position.y(), 2.0);
  EXPECT_NEAR(schedule.sample(10.5)->position.x(), 0.5, 1e-9);
  schedule.hold({4, 5, 6}, 0.1);
  EXPECT_TRUE(schedule.ended(10.6));
  EXPECT_EQ(schedule.sample(12.5)->position.x(), 4.0);
  EXPECT_EQ(schedule.sample(12.5)->yaw, 0.1);
}

TEST(ReferenceTrajectory, SaysHowManyDerivativesItComputed) {
  std::vector<TrajectorySample> samples{at(0.0, {0, 0, 0}), at(1.0, {1, 0, 0}), at(2.0, {2, 0, 0})};
  EXPECT_EQ(ReferenceTrajectory(samples).computedVelocities(), 3U);
  EXPECT_EQ(ReferenceTrajectory(samples).computedAccelerations(), 3U);
  samples[1].has_velocity = true;
  EXPECT_EQ(ReferenceTrajectory(samples).computedVelocities(), 2U);
  EXPECT_EQ(lineFrom(0.0, 5).computedAccelerations(), 0U);
  EXPECT_EQ(ReferenceTrajectory::pose({1, 2, 3}, 0.0).computedVelocities(), 0U);
}

}  // namespace
