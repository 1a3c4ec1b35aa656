#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "validation_parts.hpp"

namespace polyfly {
namespace {

// Greatest excess of a recorded command over its bound [SI units]. Floats of another width cause it.
constexpr double kBoundTolerance = 1e-9;

void countViolations(const FlightLog& log, const MultirotorOptions& options, CommandValidation* result) {
  const auto beyond = [](double value, double limit) { return std::abs(value) > limit + kBoundTolerance; };
  for (const FlightLog::Command& recorded : log.commands) {
    const AttitudeCommand& command = recorded.command;
    if (!std::isfinite(command.roll + command.pitch + command.yaw_rate + command.thrust)) {
      ++result->not_finite;
      continue;
    }
    if (beyond(command.roll, options.angle_max) || beyond(command.pitch, options.angle_max)) {
      ++result->angle_violations;
    }
    if (command.thrust < options.mass * options.thrust_min - kBoundTolerance ||
        command.thrust > options.mass * options.thrust_max + kBoundTolerance) {
      ++result->thrust_violations;
    }
    if (beyond(command.yaw_rate, options.yaw_rate_max)) ++result->yaw_rate_violations;
  }
}

double thetaDifference(const std::vector<double>& recorded, const AxisReport& replayed) {
  if (recorded.size() != static_cast<std::size_t>(replayed.size))
    return std::numeric_limits<double>::infinity();
  double greatest = 0.0;
  for (std::size_t index = 0; index < recorded.size(); ++index) {
    const double difference = std::abs(recorded[index] - replayed.theta[index]);
    greatest = worse(greatest, difference);
  }
  return greatest;
}

}  // namespace

CommandValidation validateCommands(const FlightLog& log, const std::vector<ReplaySample>& samples,
                                   const MultirotorOptions& options) {
  CommandValidation result;
  result.recorded = log.commands.size();
  countViolations(log, options, &result);
  // The last command with a stamp counts.
  std::map<double, const AttitudeCommand*> recorded;
  for (const FlightLog::Command& command : log.commands) recorded[command.stamp] = &command.command;
  std::array<DifferenceCollector, 4> differences;
  for (const ReplaySample& sample : samples) {
    const auto match = recorded.find(sample.state.stamp);
    if (match == recorded.end()) continue;
    ++result.compared;
    const AttitudeCommand& was = *match->second;
    const AttitudeCommand& is = sample.report.command;
    differences[0].add(was.roll - is.roll, sample.state.stamp);
    differences[1].add(was.pitch - is.pitch, sample.state.stamp);
    differences[2].add(was.yaw_rate - is.yaw_rate, sample.state.stamp);
    differences[3].add(was.thrust - is.thrust, sample.state.stamp);
  }
  std::set<double> stamps;
  for (const VehicleState& state : log.odometry) {
    stamps.insert(state.stamp);
    if (recorded.count(state.stamp) == 0) ++result.unanswered;
  }
  for (const FlightLog::Command& command : log.commands) {
    if (stamps.count(command.stamp) == 0) ++result.unmatched;
  }
  for (std::size_t entry = 0; entry < differences.size(); ++entry) {
    result.difference[entry] = differences[entry].result();
    const double scale = entry == 3 ? 1.0 / options.mass : 1.0;
    result.max_difference = worse(result.max_difference, scale * result.difference[entry].max);
  }
  return result;
}

StatusValidation validateStatuses(const FlightLog& log, const std::vector<ReplaySample>& samples) {
  StatusValidation result;
  std::map<double, const FlightLog::Status*> recorded;
  std::vector<double> step_times;
  for (const FlightLog::Status& status : log.statuses) {
    step_times.push_back(1e9 * status.step_time);
    ++result.recorded.at(static_cast<std::size_t>(status.status));
    if (status.reason != ControlReason::kStale) recorded[status.stamp] = &status;
  }
  for (const ReplaySample& sample : samples) {
    ++result.replayed.at(static_cast<std::size_t>(sample.report.status));
    const auto match = recorded.find(sample.state.stamp);
    if (match == recorded.end()) continue;
    ++result.compared;
    bool same =
        match->second->status == sample.report.status && match->second->reason == sample.report.reason;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      same = same && match->second->region[axis] == sample.report.axis[axis].region;
      const double difference = thetaDifference(match->second->theta[axis], sample.report.axis[axis]);
      result.max_theta_difference = worse(result.max_theta_difference, difference);
    }
    if (!same) ++result.differing;
  }
  result.step_ns = percentiles(step_times);
  return result;
}

}  // namespace polyfly
