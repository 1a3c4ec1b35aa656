#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "region_maps/region_map.hpp"
#include "validation_parts.hpp"

namespace polyfly {
namespace {

// Greatest excess of a recorded command over its bound [SI units]. Floats of another width cause it.
constexpr double kBoundTolerance = 1e-9;

void countViolations(const ReplayedFlight& flight, CommandValidation* result) {
  const MultirotorOptions& options = flight.options;
  const auto beyond = [](double value, double limit) { return std::abs(value) > limit + kBoundTolerance; };
  for (const FlightLog::Command& recorded : flight.log.commands) {
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

// Odometry and commands without their counterpart.
void countAlone(const FlightLog& log, CommandValidation* result) {
  const auto recorded = log.commandsByStamp();
  std::set<double> stamps;
  for (const VehicleState& state : log.odometry) {
    stamps.insert(state.stamp);
    if (recorded.count(state.stamp) == 0) ++result->unanswered;
  }
  for (const FlightLog::Command& command : log.commands) {
    if (stamps.count(command.stamp) == 0) ++result->unmatched;
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

// Difference of a recorded input to what the map gives at the recorded parameters; 0 where the map did not answer.
double lawDifference(const FlightLog::Status& status, std::size_t axis, const RegionMap& map) {
  const std::vector<double>& theta = status.theta[axis];
  const bool is_law = status.status == ControlStatus::kOptimal && status.region[axis] >= 0;
  if (!is_law || theta.size() != map.parameters().size()) return 0.0;
  std::vector<double> input(map.inputs().size());
  if (map.evaluate(theta.data(), input.data()).status != LookupStatus::kInside) return 0.0;
  return std::abs(status.input[axis] - input.front());
}

}  // namespace

CommandValidation validateCommands(const std::vector<ReplayedFlight>& flights) {
  CommandValidation result;
  std::array<DifferenceCollector, 4> differences;
  for (const ReplayedFlight& flight : flights) {
    result.recorded += flight.log.commands.size();
    countViolations(flight, &result);
    countAlone(flight.log, &result);
    const auto recorded = flight.log.commandsByStamp();
    for (const ReplaySample& sample : flight.samples) {
      const auto match = recorded.find(sample.state.stamp);
      if (sample.ignorance || match == recorded.end()) continue;
      ++result.compared;
      const AttitudeCommand& was = *match->second;
      const AttitudeCommand& is = sample.report.command;
      differences[0].add(was.roll - is.roll, sample.state.stamp);
      differences[1].add(was.pitch - is.pitch, sample.state.stamp);
      differences[2].add(was.yaw_rate - is.yaw_rate, sample.state.stamp);
      differences[3].add(was.thrust - is.thrust, sample.state.stamp);
    }
  }
  for (std::size_t entry = 0; entry < differences.size(); ++entry) {
    result.difference[entry] = differences[entry].result();
    const double scale = entry == 3 ? 1.0 / flights.front().options.mass : 1.0;
    result.max_difference = worse(result.max_difference, scale * result.difference[entry].max);
  }
  return result;
}

StatusValidation validateStatuses(const std::vector<ReplayedFlight>& flights, const AxisMaps& maps) {
  StatusValidation result;
  std::vector<double> step_times;
  for (const ReplayedFlight& flight : flights) {
    const auto recorded = flight.log.statusesByStamp();
    for (const FlightLog::Status& status : flight.log.statuses) {
      step_times.push_back(1e9 * status.step_time);
      ++result.recorded.at(static_cast<std::size_t>(status.status));
      if (status.reason == ControlReason::kStale) continue;
      for (std::size_t axis = 0; axis < maps.size() && status.reason == ControlReason::kNone; ++axis)
        result.max_input_difference =
            worse(result.max_input_difference, lawDifference(status, axis, *maps[axis]));
    }
    for (const ReplaySample& sample : flight.samples) {
      if (sample.ignorance) continue;
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
  }
  result.step_ns = percentiles(step_times);
  return result;
}

}  // namespace polyfly
