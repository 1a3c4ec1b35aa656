#include "identification/motion.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "identification/excitation.hpp"
#include "identification/flight_phases.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kLeastStretch = 1.0;  // [s]

// The samples of a signal that can be used, see cleaned. Throws Error naming source and signal if there are none.
TimeSeries usableSignal(const FlightSignals& signals, const std::string& name) {
  TimeSeries series = cleaned(signals.at(name));
  if (series.time.empty()) throw Error(signals.source + ": " + name + ": no sample");
  return series;
}

// Attitude at any time. Sine and cosine of yaw are interpolated, because the angle itself may wrap.
class AttitudeSignals {
 public:
  // From roll, pitch, yaw. Throws Error where one is missing.
  explicit AttitudeSignals(const FlightSignals& signals)
      : roll_(usableSignal(signals, "roll")),
        pitch_(usableSignal(signals, "pitch")),
        yaw_sine_(usableSignal(signals, "yaw")),
        yaw_cosine_(yaw_sine_) {
    for (double& value : yaw_sine_.value) value = std::sin(value);
    for (double& value : yaw_cosine_.value) value = std::cos(value);
  }

  double yaw(double time) const {
    return std::atan2(interpolated(yaw_sine_, time), interpolated(yaw_cosine_, time));
  }

  // The body's z axis in W.
  Eigen::Vector3d up(double time) const {
    return Eigen::AngleAxisd(yaw(time), Eigen::Vector3d::UnitZ()) *
           (Eigen::AngleAxisd(interpolated(pitch_, time), Eigen::Vector3d::UnitY()) *
            (Eigen::AngleAxisd(interpolated(roll_, time), Eigen::Vector3d::UnitX()) *
             Eigen::Vector3d::UnitZ()));
  }

 private:
  TimeSeries roll_;
  TimeSeries pitch_;
  TimeSeries yaw_sine_;
  TimeSeries yaw_cosine_;
};

std::vector<double> smoothed(const std::vector<double>& time, const std::vector<double>& value,
                             double half_width) {
  return smoothedMean(time, cumulativeIntegral(time, value), half_width);
}

// Commands up to 1 are no newtons: no vehicle of which this is the mass flies these maps.
bool isShare(const FlightSignals& signals, const TimeSeries& thrust, const MotionOptions& options) {
  if (options.newtons || thrust.time.empty()) return false;
  const double greatest = *std::max_element(thrust.value.begin(), thrust.value.end());
  return signals.thrust_is_share || greatest <= 1.0;
}

// The stretches of the velocity's samples in which every signal is known, through the machinery that cuts
// loops.
std::vector<LoopSegment> stretches(const TimeSeries& velocity, const FlightSignals& signals,
                                   const std::vector<TimeWindow>& wanted) {
  LoopRecord record;
  record.response = velocity;
  record.command = {{velocity.time.front()}, {0.0}};
  std::vector<TimeWindow> windows = wanted;
  if (windows.empty()) {
    windows = windowsWithout({{velocity.time.front(), velocity.time.back()}}, signals.not_flight);
  }
  for (const char* name : {"vx", "vy", "vz", "roll", "pitch", "yaw", "thrust_cmd"}) {
    if (signals.has(name)) windows = cutAtFarSteps(windows, usableSignal(signals, name).time);
  }
  std::vector<LoopSegment> found = cutSegments(record, windows, 0.0);
  found.erase(std::remove_if(found.begin(), found.end(),
                             [](const LoopSegment& segment) { return segment.duration() < kLeastStretch; }),
              found.end());
  return found;
}

// Fills one stretch from row `from` on.
void addStretch(const std::vector<double>& time, const std::array<TimeSeries, 3>& velocity,
                const AttitudeSignals& attitude, const TimeSeries* thrust, const MotionOptions& options,
                Eigen::Index from, Motion* motion) {
  const std::size_t count = time.size();
  std::array<std::vector<double>, 3> speed;
  std::array<std::vector<double>, 3> up;
  std::vector<double> lift(count, 0.0);
  std::array<std::vector<double>, 3> pull;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d direction = attitude.up(time[i]);
    const double command = thrust != nullptr ? heldValue(*thrust, time[i]) : 0.0;
    lift[i] = command * direction.z();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto along = static_cast<Eigen::Index>(axis);
      speed[axis].push_back(interpolated(velocity[axis], time[i]));
      up[axis].push_back(direction[along]);
      pull[axis].push_back(motion->thrust_known ? command / options.mass * direction[along] : 0.0);
    }
  }
  std::array<std::vector<double>, 3> acceleration;
  for (std::size_t axis = 0; axis < 3; ++axis)
    acceleration[axis] = smoothedMean(time, speed[axis], options.smoothing);
  if (!motion->thrust_known) {
    // As much thrust as the vertical motion shows.
    for (std::size_t i = 0; i < count; ++i) {
      const double vertical = acceleration[2][i] + options.gravity + options.drag.z() * speed[2][i];
      for (std::size_t axis = 0; axis < 3; ++axis) pull[axis][i] = vertical / up[2][i] * up[axis][i];
    }
  }
  for (std::size_t i = 0; i < count; ++i)
    motion->yaw[from + static_cast<Eigen::Index>(i)] = attitude.yaw(time[i]);
  const std::vector<double> smooth_lift = smoothed(time, lift, options.smoothing);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::vector<double> smooth_pull = smoothed(time, pull[axis], options.smoothing);
    const std::vector<double> smooth_speed = smoothed(time, speed[axis], options.smoothing);
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = from + static_cast<Eigen::Index>(i);
      const auto column = static_cast<Eigen::Index>(axis);
      motion->acceleration(row, column) = acceleration[axis][i];
      motion->expected(row, column) = smooth_pull[i] - (axis == 2 ? options.gravity : 0.0);
      motion->velocity(row, column) = smooth_speed[i];
      motion->lift[row] = smooth_lift[i];
    }
  }
}

}  // namespace

Motion motionOf(const FlightSignals& signals, const MotionOptions& options) {
  const std::array<TimeSeries, 3> velocity = {usableSignal(signals, "vx"), usableSignal(signals, "vy"),
                                              usableSignal(signals, "vz")};
  const AttitudeSignals attitude(signals);
  TimeSeries thrust;
  if (signals.has("thrust_cmd")) thrust = usableSignal(signals, "thrust_cmd");
  Motion motion;
  motion.source = signals.source;
  motion.thrust_known = options.mass > 0.0 && !thrust.time.empty();
  motion.lift_is_share = isShare(signals, thrust, options);
  if (motion.thrust_known && motion.lift_is_share) {
    throw Error(signals.source +
                ": thrust_cmd is a share of full thrust, with which no mass goes; leave --mass out, or say "
                "--newtons if it is in newtons");
  }
  const std::vector<LoopSegment> parts = stretches(velocity[0], signals, options.windows);
  if (parts.empty()) {
    throw Error(signals.source + ": no stretch of velocities of a second or more" +
                whyNotFlight(signals.not_flight, options.windows) + whyUnusable(signals.at("vx")));
  }
  motion.starts.push_back(0);
  for (const LoopSegment& part : parts) {
    motion.time.insert(motion.time.end(), part.time.begin(), part.time.end());
    motion.starts.push_back(motion.time.size());
  }
  const auto rows = static_cast<Eigen::Index>(motion.time.size());
  motion.acceleration.resize(rows, 3);
  motion.expected.resize(rows, 3);
  motion.velocity.resize(rows, 3);
  motion.lift.resize(rows);
  motion.yaw.resize(rows);
  for (std::size_t i = 0; i < parts.size(); ++i) {
    addStretch(parts[i].time, velocity, attitude, thrust.time.empty() ? nullptr : &thrust, options,
               static_cast<Eigen::Index>(motion.starts[i]), &motion);
  }
  return motion;
}

}  // namespace polyfly
