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

// Each column through the sliding mean.
Eigen::MatrixXd slopes(const std::vector<double>& time, Eigen::MatrixXd columns, double half_width) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const std::vector<double> column(columns.col(k).data(), columns.col(k).data() + columns.rows());
    const std::vector<double> slope = smoothedMean(time, column, half_width);
    columns.col(k) = Eigen::Map<const Eigen::VectorXd>(slope.data(), columns.rows());
  }
  return columns;
}

Eigen::MatrixXd smoothed(const std::vector<double>& time, Eigen::MatrixXd columns, double half_width) {
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const std::vector<double> column(columns.col(k).data(), columns.col(k).data() + columns.rows());
    const std::vector<double> integral = cumulativeIntegral(time, column);
    columns.col(k) = Eigen::Map<const Eigen::VectorXd>(integral.data(), columns.rows());
  }
  return slopes(time, std::move(columns), half_width);
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
                const AttitudeSignals& attitude, const TimeSeries& thrust, const MotionOptions& options,
                Eigen::Index from, Motion* motion) {
  const auto count = static_cast<Eigen::Index>(time.size());
  Eigen::MatrixXd speed(count, 3);
  Eigen::MatrixXd up(count, 3);
  Eigen::VectorXd command = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double now = time[static_cast<std::size_t>(i)];
    up.row(i) = attitude.up(now);
    motion->yaw[from + i] = attitude.yaw(now);
    for (std::size_t axis = 0; axis < 3; ++axis)
      speed(i, static_cast<Eigen::Index>(axis)) = interpolated(velocity[axis], now);
    if (!thrust.time.empty()) command[i] = heldValue(thrust, now);
  }
  const Eigen::MatrixXd acceleration = slopes(time, speed, options.smoothing);
  Eigen::VectorXd pull = command / options.mass;
  if (!motion->thrust_known) {
    // As much thrust as the vertical motion shows.
    pull = (acceleration.col(2).array() + options.gravity + options.drag.z() * speed.col(2).array()) /
           up.col(2).array();
  }
  motion->acceleration.middleRows(from, count) = acceleration;
  motion->expected.middleRows(from, count) = smoothed(time, pull.asDiagonal() * up, options.smoothing);
  motion->expected.col(2).segment(from, count).array() -= options.gravity;
  motion->velocity.middleRows(from, count) = smoothed(time, speed, options.smoothing);
  motion->lift.segment(from, count) = smoothed(time, command.cwiseProduct(up.col(2)), options.smoothing);
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
    motion.starts.push_back(static_cast<Eigen::Index>(motion.time.size()));
  }
  const auto rows = static_cast<Eigen::Index>(motion.time.size());
  motion.acceleration.resize(rows, 3);
  motion.expected.resize(rows, 3);
  motion.velocity.resize(rows, 3);
  motion.lift.resize(rows);
  motion.yaw.resize(rows);
  for (std::size_t i = 0; i < parts.size(); ++i)
    addStretch(parts[i].time, velocity, attitude, thrust, options, motion.starts[i], &motion);
  return motion;
}

}  // namespace polyfly
