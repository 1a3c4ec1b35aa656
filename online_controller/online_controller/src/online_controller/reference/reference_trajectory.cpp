#include "online_controller/reference/reference_trajectory.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "online_controller/types/attitude.hpp"
#include "online_controller/types/spline.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::string at(std::size_t index) { return "trajectory: sample " + std::to_string(index) + ": "; }

void checkSample(const TrajectorySample& sample, std::size_t index) {
  const auto bounded = [](double value) { return std::abs(value) <= ReferenceTrajectory::kLargestNumber; };
  bool good = std::isfinite(sample.time) && bounded(sample.yaw) && bounded(sample.yaw_rate);
  for (int i = 0; i < 3; ++i) {
    good =
        good && bounded(sample.position[i]) && bounded(sample.velocity[i]) && bounded(sample.acceleration[i]);
  }
  if (!good) throw Error(at(index) + "all entries must be finite and at most 1e6 in magnitude");
}

void check(const std::vector<TrajectorySample>& samples) {
  if (samples.empty()) throw Error("trajectory: must have at least one sample");
  if (samples.size() > ReferenceTrajectory::kMaxSamples) {
    throw Error("trajectory: must have at most " + std::to_string(ReferenceTrajectory::kMaxSamples) +
                " samples, got " + std::to_string(samples.size()));
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    checkSample(samples[i], i);
    // The tolerance lets stamps in nanoseconds pass that are rounded in seconds since 1970.
    constexpr double kTimeRounding = 1e-6;
    if (i > 0 &&
        samples[i].time - samples[i - 1].time < ReferenceTrajectory::kLeastInterval - kTimeRounding) {
      throw Error(at(i) + "time must be at least " + std::to_string(ReferenceTrajectory::kLeastInterval) +
                  " s after the sample before");
    }
  }
}

/// Derivative of the velocity at samples[i], of the parabola through it and its neighbours.
Eigen::Vector3d velocitySlope(const std::vector<TrajectorySample>& samples, std::size_t i) {
  const auto chord = [&](std::size_t from) -> Eigen::Vector3d {
    return (samples[from + 1].velocity - samples[from].velocity) /
           (samples[from + 1].time - samples[from].time);
  };
  if (i == 0) return chord(0);
  if (i + 1 == samples.size()) return chord(i - 1);
  const double before = samples[i].time - samples[i - 1].time;
  const double after = samples[i + 1].time - samples[i].time;
  return (after * chord(i - 1) + before * chord(i)) / (before + after);
}

Knot toKnot(const TrajectorySample& sample) {
  Knot knot;
  knot.time = sample.time;
  knot.value << sample.position, sample.yaw;
  knot.slope << sample.velocity, sample.yaw_rate;
  return knot;
}

/// Velocities between the samples `first` and `last`, of which those two may have theirs, and the
/// accelerations of all that have none: the mean of both sides where two splines meet. `sides` counts them.
void followSpline(std::vector<TrajectorySample>& samples, std::size_t first, std::size_t last,
                  std::vector<int>& sides) {
  std::vector<Knot> knots;
  knots.reserve(last - first + 1);
  for (std::size_t i = first; i <= last; ++i) knots.push_back(toKnot(samples[i]));
  fitSpline(knots, samples[first].has_velocity, samples[last].has_velocity);
  for (std::size_t i = first; i <= last; ++i) {
    TrajectorySample& sample = samples[i];
    const Knot& knot = knots[i - first];
    if (!sample.has_velocity) {
      sample.velocity = knot.slope.head<3>();
      sample.yaw_rate = knot.slope(3);
    }
    ++sides[i];
    if (!sample.has_acceleration)
      sample.acceleration += (knot.curvature.head<3>() - sample.acceleration) / sides[i];
  }
}

void complete(std::vector<TrajectorySample>& samples) {
  for (std::size_t i = 1; i < samples.size(); ++i) {
    samples[i].yaw = samples[i - 1].yaw + wrapAngle(samples[i].yaw - samples[i - 1].yaw);
  }
  if (samples.size() < 2) return;
  std::vector<int> sides(samples.size(), 0);
  // Last sample with a velocity, or the very first sample.
  std::size_t first = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (!samples[i].has_velocity && i + 1 < samples.size()) continue;
    const bool all_given = i == first + 1 && samples[first].has_velocity && samples[i].has_velocity;
    if (!all_given) followSpline(samples, first, i, sides);
    first = i;
  }
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (sides[i] == 0 && !samples[i].has_acceleration) samples[i].acceleration = velocitySlope(samples, i);
  }
}

Reference atRest(const TrajectorySample& sample) noexcept {
  Reference reference;
  reference.position = sample.position;
  reference.yaw = wrapAngle(sample.yaw);
  return reference;
}

Reference between(const TrajectorySample& from, const TrajectorySample& to, double time) noexcept {
  const double h = to.time - from.time;
  const double s = (time - from.time) / h;
  Reference reference;
  for (int i = 0; i < 3; ++i) {
    // p(s) = p0 + c1 s + ... + c5 s^5 with s in [0, 1].
    const double rise = to.position[i] - from.position[i];
    const double v0 = from.velocity[i] * h;
    const double v1 = to.velocity[i] * h;
    const double a0 = from.acceleration[i] * h * h;
    const double a1 = to.acceleration[i] * h * h;
    const double c2 = 0.5 * a0;
    const double c3 = 10.0 * rise - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
    const double c4 = -15.0 * rise + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
    const double c5 = 6.0 * rise - 3.0 * (v0 + v1) - 0.5 * (a0 - a1);
    reference.position[i] = from.position[i] + s * (v0 + s * (c2 + s * (c3 + s * (c4 + s * c5))));
    reference.velocity[i] = (v0 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / h;
    reference.acceleration[i] = (2.0 * c2 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (h * h);
    reference.jerk[i] = (6.0 * c3 + s * (24.0 * c4 + s * 60.0 * c5)) / (h * h * h);
  }
  const double rise = to.yaw - from.yaw;
  const double r0 = from.yaw_rate * h;
  const double r1 = to.yaw_rate * h;
  const double c2 = 3.0 * rise - 2.0 * r0 - r1;
  const double c3 = r0 + r1 - 2.0 * rise;
  reference.yaw = wrapAngle(from.yaw + s * (r0 + s * (c2 + s * c3)));
  reference.yaw_rate = (r0 + s * (2.0 * c2 + s * 3.0 * c3)) / h;
  return reference;
}

}  // namespace

ReferenceTrajectory::ReferenceTrajectory(std::vector<TrajectorySample> samples)
    : samples_(std::move(samples)) {
  check(samples_);
  complete(samples_);
  if (samples_.size() < 2) return;
  for (const TrajectorySample& sample : samples_) {
    computed_velocities_ += sample.has_velocity ? 0 : 1;
    computed_accelerations_ += sample.has_acceleration ? 0 : 1;
  }
}

ReferenceTrajectory ReferenceTrajectory::pose(const Eigen::Vector3d& position, double yaw) {
  TrajectorySample sample;
  sample.position = position;
  sample.yaw = yaw;
  return ReferenceTrajectory({sample});
}

void ReferenceTrajectory::becomePose(const Eigen::Vector3d& position, double yaw) {
  samples_.resize(1);
  samples_.front() = TrajectorySample{};
  samples_.front().position = position;
  samples_.front().yaw = yaw;
  computed_velocities_ = 0;
  computed_accelerations_ = 0;
}

ReferenceTrajectory ReferenceTrajectory::joined(const ReferenceTrajectory& first,
                                                const ReferenceTrajectory& second, double offset) {
  std::vector<TrajectorySample> samples = first.samples_;
  TrajectorySample next = second.samples_.front();
  next.time += offset;
  // As they are on the way that follows; at rest where that is a pose.
  next.has_velocity = true;
  next.has_acceleration = true;
  if (second.samples_.size() < 2) {
    next.velocity.setZero();
    next.acceleration.setZero();
    next.yaw_rate = 0.0;
  }
  samples.push_back(next);
  return ReferenceTrajectory(std::move(samples));
}

Reference ReferenceTrajectory::sample(double time) const noexcept {
  if (empty()) return {};
  // Written so that NaN holds the first pose.
  if (samples_.size() == 1 || !(time >= samples_.front().time)) return atRest(samples_.front());
  if (time > samples_.back().time) return atRest(samples_.back());
  const auto next = std::upper_bound(samples_.begin() + 1, samples_.end() - 1, time,
                                     [](double t, const TrajectorySample& s) { return t < s.time; });
  return between(*(next - 1), *next, time);
}

}  // namespace polyfly
