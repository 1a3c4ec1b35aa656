#include "thrust_samples.hpp"

#include <algorithm>
#include <cmath>

#include "attitude_signals.hpp"
#include "identification/excitation.hpp"
#include "identification/flight_phases.hpp"
#include "interpolate.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Half width of the mean over the voltage: what the motors draw within seconds belongs to the curve [s].
constexpr double kVoltageSmoothing = 5.0;
constexpr double kLeastThrustStretch = 2.0;  // [s]
// How far back the command is needed: the greatest delay and some lags [s].
constexpr double kCommandReach = 3.0;

TimeSeries shareOf(const FlightSignals& signals) {
  const TimeSeries command = usableSignal(signals, "thrust_cmd");
  const auto [least, greatest] = std::minmax_element(command.value.begin(), command.value.end());
  if (*least < 0.0 || *greatest > 1.0) {
    throw Error(signals.source + ": thrust_cmd: must be a share of full thrust from 0 to 1, is " +
                std::to_string(*least) + " to " + std::to_string(*greatest) +
                "; --signal thrust_cmd=PLACE names another one, as /mavros/setpoint_raw/attitude:thrust");
  }
  return command;
}

std::vector<LoopSegment> thrustSegments(const LoopRecord& record, const std::vector<TimeWindow>& wanted) {
  std::vector<TimeWindow> windows = wanted;
  if (windows.empty()) {
    windows =
        windowsWithout({{record.response.time.front(), record.response.time.back()}}, record.not_flight);
  }
  windows = cutAtFarSteps(windows, record.response.time);
  windows = cutAtFarSteps(windows, record.command.time);
  std::vector<LoopSegment> found = cutSegments(record, windows, kCommandReach);
  found.erase(
      std::remove_if(found.begin(), found.end(),
                     [](const LoopSegment& segment) { return segment.duration() < kLeastThrustStretch; }),
      found.end());
  return found;
}

Eigen::VectorXd sampled(const TimeSeries& series, const Eigen::VectorXd& time) {
  return time.unaryExpr([&series](double at) { return interpolated(series, at); });
}

Eigen::VectorXd slowVoltage(const FlightSignals& signals, const Eigen::VectorXd& time) {
  TimeSeries voltage = cleanSignal(signals, "voltage");
  if (voltage.time.size() < 3) return {};
  for (const double value : voltage.value) {
    if (!(value > 0.0))
      throw Error(signals.source + ": voltage: must be above 0, is " + std::to_string(value));
  }
  voltage.value =
      smoothedMean(voltage.time, cumulativeIntegral(voltage.time, voltage.value), kVoltageSmoothing);
  return sampled(voltage, time);
}

// Speed along the body's z.
Eigen::VectorXd climbOf(const FlightSignals& signals, const Eigen::VectorXd& time) {
  for (const char* name : {"roll", "pitch", "yaw", "vx", "vy", "vz"}) {
    if (cleanSignal(signals, name).time.empty()) return {};
  }
  const AttitudeSignals attitude(signals);
  const TimeSeries speeds[] = {usableSignal(signals, "vx"), usableSignal(signals, "vy"),
                               usableSignal(signals, "vz")};
  return time.unaryExpr([&](double at) {
    const Eigen::Vector3d velocity(interpolated(speeds[0], at), interpolated(speeds[1], at),
                                   interpolated(speeds[2], at));
    return velocity.dot(attitude.up(at));
  });
}

// Over a flight the mean of the vertical acceleration is gravity's.
double accelerometerScale(const FlightSignals& signals, const ThrustRecord& record, double weight) {
  if (!signals.has("specific_force_z")) return 1.0;
  const TimeSeries roll = cleanSignal(signals, "roll");
  const TimeSeries pitch = cleanSignal(signals, "pitch");
  if (roll.time.empty() || pitch.time.empty()) return 1.0;
  const Eigen::ArrayXd upright =
      sampled(roll, record.time).array().cos() * sampled(pitch, record.time).array().cos();
  return (record.force.array() * upright).mean() / weight;
}

void append(Eigen::VectorXd* to, const Eigen::VectorXd& more) {
  Eigen::VectorXd both(to->size() + more.size());
  both << *to, more;
  *to = std::move(both);
}

}  // namespace

ThrustRecord thrustRecordOf(const FlightSignals& signals, const std::vector<TimeWindow>& windows, double mass,
                            double gravity) {
  LoopRecord loop = axisRecords(signals, "thrust").training;
  loop.command = shareOf(signals);
  if (loop.response.time.empty())
    throw Error(signals.source + ": specific_force_z, or vz with roll and pitch: no sample");
  ThrustRecord record;
  record.source = signals.source;
  record.segments = thrustSegments(loop, windows);
  if (record.segments.empty()) {
    throw Error(signals.source + ": no stretch of thrust of two seconds or more" +
                whyNotFlight(signals.not_flight, windows));
  }
  for (const LoopSegment& segment : record.segments) {
    const auto rows = static_cast<Eigen::Index>(segment.time.size());
    append(&record.time, Eigen::Map<const Eigen::VectorXd>(segment.time.data(), rows));
    append(&record.force, mass * Eigen::Map<const Eigen::VectorXd>(segment.response.data(), rows));
  }
  record.climb = mass * climbOf(signals, record.time);
  record.voltage = slowVoltage(signals, record.time);
  record.accelerometer_scale = accelerometerScale(signals, record, mass * gravity);
  return record;
}

Eigen::VectorXd laggedCommand(const ThrustRecord& record, const LoopShape& shape) {
  Eigen::VectorXd command(record.time.size());
  Eigen::Index row = 0;
  for (const LoopSegment& segment : record.segments) {
    const LoopBasis basis = loopBasis(shape, segment);
    const double settled = heldValue(segment.command, segment.time.front() - shape.delay);
    for (std::size_t i = 0; i < segment.time.size(); ++i)
      command[row++] = basis.forced[i] + settled * basis.free.front()[i];
  }
  return command;
}

ThrustSamples rowsOf(const ThrustSamples& samples,
                     const std::vector<std::pair<Eigen::Index, Eigen::Index>>& stretches) {
  std::vector<ThrustSamples> parts;
  for (const auto& [from, to] : stretches) {
    const auto cut = [first = from, count = to - from](const Eigen::VectorXd& whole) {
      return whole.size() == 0 ? Eigen::VectorXd() : Eigen::VectorXd(whole.segment(first, count));
    };
    ThrustSamples part = {cut(samples.time),
                          cut(samples.command),
                          cut(samples.by_lag),
                          cut(samples.force),
                          cut(samples.climb),
                          cut(samples.battery),
                          {0}};
    for (const Eigen::Index start : samples.starts) {
      if (start > from && start < to) part.starts.push_back(start - from);
    }
    part.starts.push_back(to - from);
    parts.push_back(std::move(part));
  }
  return stacked(parts);
}

ThrustSamples stacked(const std::vector<ThrustSamples>& all) {
  ThrustSamples together;
  together.starts = {0};
  for (const ThrustSamples& one : all) {
    const Eigen::Index before = together.rows();
    for (std::size_t i = 1; i < one.starts.size(); ++i) together.starts.push_back(before + one.starts[i]);
    append(&together.time, one.time);
    append(&together.command, one.command);
    append(&together.by_lag, one.by_lag);
    append(&together.force, one.force);
    append(&together.climb, one.climb);
    append(&together.battery, one.battery);
  }
  return together;
}

}  // namespace polyfly
