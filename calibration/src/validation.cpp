#include "calibration/validation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "online_axis.hpp"
#include "online_controller/axis.hpp"

namespace polyfly {
namespace {

constexpr double kBoundTolerance =
    1e-9;  // of a recorded command beyond its bound, from a float of other width [SI]
constexpr double kRestTolerance = 1e-6;  // velocity and acceleration of a reference that rests [m/s, m/s^2]
constexpr double kLeastHold = 2.0;       // shorter rests say nothing about the steady state [s]
constexpr double kSettlingShare = 0.5;   // of the hold, left out for the transient to die

// The greater of two sizes, NaN if one of them is: it must never hide.
double worse(double one, double other) {
  if (std::isnan(one) || std::isnan(other)) return std::numeric_limits<double>::quiet_NaN();
  return std::max(one, other);
}

// Collects differences into their greatest and their mean square.
class DifferenceCollector {
 public:
  void add(double difference, double stamp) {
    const double size = std::abs(difference);
    if (!std::isnan(result_.max) && !(size <= result_.max)) {
      result_.max = size;
      result_.stamp = stamp;
    }
    sum_ += size * size;
    ++count_;
    result_.rms = std::sqrt(sum_ / static_cast<double>(count_));
  }
  const Difference& result() const { return result_; }
  std::size_t count() const { return count_; }

 private:
  Difference result_;
  double sum_ = 0.0;
  std::size_t count_ = 0;
};

void countLookup(LookupStatus status, AxisValidation* axis) {
  switch (status) {
    case LookupStatus::kInside:
      ++axis->inside;
      break;
    case LookupStatus::kOutsideBox:
      ++axis->outside_box;
      break;
    case LookupStatus::kOutsidePartition:
      ++axis->outside_partition;
      break;
    case LookupStatus::kNotFinite:
      ++axis->not_finite;
      break;
  }
}

std::vector<ParameterUse> parameterList(const RegionMap& map) {
  std::vector<ParameterUse> list;
  for (const Signal& signal : map.parameters()) {
    ParameterUse use;
    use.name = signal.name;
    use.unit = signal.unit;
    use.lower = signal.lower;
    use.upper = signal.upper;
    use.least = std::numeric_limits<double>::infinity();
    use.greatest = -use.least;
    list.push_back(use);
  }
  return list;
}

void countParameters(const AxisReport& report, std::vector<ParameterUse>* uses) {
  for (std::size_t index = 0; index < uses->size() && index < static_cast<std::size_t>(report.size);
       ++index) {
    ParameterUse& use = (*uses)[index];
    const double value = report.theta[index];
    use.least = std::min(use.least, value);
    use.greatest = std::max(use.greatest, value);
    // The box as the map tests it is wider by its tolerance; a sample that it holds is inside for every
    // parameter.
    if (report.lookup == LookupStatus::kOutsideBox && !(value >= use.lower && value <= use.upper))
      ++use.outside;
  }
}

AxisValidation validateAxis(const std::vector<ReplaySample>& samples, const RegionMap& map,
                            std::size_t index) {
  AxisValidation axis;
  axis.axis = kAxisNames[index].axis;
  axis.input = map.inputs().front().name;
  axis.input_unit = map.inputs().front().unit;
  axis.map_path = map.path();
  axis.regions = map.regionCount();
  axis.parameters = parameterList(map);
  OnlineAxis online(map);
  std::set<std::uint32_t> visited;
  std::vector<double> thetas;
  std::vector<double> input(map.inputs().size());
  DifferenceCollector qp;
  DifferenceCollector tracking;
  for (const ReplaySample& sample : samples) {
    if (!sample.has_reference) continue;
    const AxisReport& report = sample.report.axis[index];
    ++axis.samples;
    countLookup(report.lookup, &axis);
    countParameters(report, &axis.parameters);
    const auto along = static_cast<Eigen::Index>(index);
    tracking.add(sample.state.position[along] - sample.reference.position[along], sample.state.stamp);
    if (report.lookup != LookupStatus::kInside) continue;
    const Lookup found = map.evaluate(report.theta.data(), input.data());
    visited.insert(found.region);
    thetas.insert(thetas.end(), report.theta.begin(), report.theta.begin() + report.size);
    const std::optional<double> solved = online.input(report.theta.data());
    if (solved) {
      qp.add(input.front() - *solved, sample.state.stamp);
      axis.qp_series.push_back({sample.state.stamp, std::abs(input.front() - *solved)});
    } else {
      ++axis.qp_failures;
    }
  }
  axis.visited = visited.size();
  for (std::uint32_t region = 0; region < axis.regions; ++region) {
    if (visited.count(region) == 0) axis.never_visited.push_back(region);
  }
  axis.qp = qp.result();
  axis.qp_compared = qp.count();
  axis.tracking = tracking.result();
  axis.lookups = measureLookups(map, thetas);
  axis.lookup_ns = percentiles(axis.lookups.in_order);
  axis.lookup_shuffled_ns = percentiles(axis.lookups.shuffled);
  return axis;
}

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

CommandValidation validateCommands(const FlightLog& log, const std::vector<ReplaySample>& samples,
                                   const MultirotorOptions& options) {
  CommandValidation result;
  result.recorded = log.commands.size();
  countViolations(log, options, &result);
  std::map<double, const AttitudeCommand*> recorded;  // the last one with a stamp counts
  for (const FlightLog::Command& command : log.commands) recorded[command.stamp] = &command.command;
  std::set<double> sampled;
  std::array<DifferenceCollector, 4> differences;
  for (const ReplaySample& sample : samples) {
    sampled.insert(sample.state.stamp);
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
  result.unanswered = log.odometry.size() - result.compared;
  for (const FlightLog::Command& command : log.commands) {
    if (sampled.count(command.stamp) == 0) ++result.unmatched;
  }
  for (std::size_t entry = 0; entry < differences.size(); ++entry) {
    result.difference[entry] = differences[entry].result();
    const double scale = entry == 3 ? 1.0 / options.mass : 1.0;
    result.max_difference = worse(result.max_difference, scale * result.difference[entry].max);
  }
  return result;
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

bool rests(const ReplaySample& sample) {
  return sample.has_reference && sample.reference.velocity.norm() <= kRestTolerance &&
         sample.reference.acceleration.norm() <= kRestTolerance;
}

std::optional<HoldOffset> holdOffset(const FlightLog& log, const std::vector<ReplaySample>& samples) {
  std::size_t first = samples.size();
  while (first > 0 && rests(samples[first - 1])) --first;
  if (first == samples.size() || samples.back().state.stamp - samples[first].state.stamp < kLeastHold) {
    return std::nullopt;
  }
  HoldOffset hold;
  hold.to = samples.back().state.stamp;
  hold.from = samples[first].state.stamp + kSettlingShare * (hold.to - samples[first].state.stamp);
  double count = 0.0;
  for (std::size_t index = first; index < samples.size(); ++index) {
    const ReplaySample& sample = samples[index];
    if (sample.state.stamp < hold.from) continue;
    hold.offset += sample.state.position - sample.reference.position;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      hold.estimate[static_cast<Eigen::Index>(axis)] += sample.report.axis[axis].disturbance;
    }
    count += 1.0;
  }
  hold.offset /= count;
  hold.estimate /= count;
  Eigen::Vector3d disturbance = Eigen::Vector3d::Zero();
  double disturbances = 0.0;
  for (const FlightLog::Disturbance& sample : log.disturbances) {
    if (sample.stamp < hold.from || sample.stamp > hold.to) continue;
    disturbance += sample.acceleration;
    disturbances += 1.0;
  }
  if (disturbances > 0.0) hold.disturbance = disturbance / disturbances;
  return hold;
}

void validateTracking(const std::vector<ReplaySample>& samples, ValidationReport* report) {
  DifferenceCollector tracking;
  for (const ReplaySample& sample : samples) {
    report->top_speed = std::max(report->top_speed, sample.state.velocity.norm());
    if (!sample.has_reference) continue;
    ++report->tracked_samples;
    tracking.add((sample.state.position - sample.reference.position).norm(), sample.state.stamp);
    const auto outside = [](const AxisReport& axis) { return axis.lookup != LookupStatus::kInside; };
    if (std::any_of(sample.report.axis.begin(), sample.report.axis.end(), outside))
      ++report->outside_map_samples;
  }
  report->tracking = tracking.result();
  if (report->tracked_samples > 0) {
    report->coverage =
        1.0 - static_cast<double>(report->outside_map_samples) / static_cast<double>(report->tracked_samples);
  }
}

}  // namespace

std::size_t ValidationReport::regionCount() const {
  return axes[0].regions + axes[1].regions + axes[2].regions;
}

std::pair<double, double> ParameterUse::proposedRange() const {
  constexpr double kBeyond = 0.1;  // of the range that was met
  const double more = kBeyond * (greatest - least);
  return {least < lower ? least - more : lower, greatest > upper ? greatest + more : upper};
}

std::size_t ValidationReport::visitedCount() const {
  return axes[0].visited + axes[1].visited + axes[2].visited;
}

double ValidationReport::maxQpDifference() const {
  double greatest = 0.0;
  for (const AxisValidation& axis : axes) {
    greatest = worse(greatest, axis.qp.max);
  }
  return greatest;
}

std::size_t ValidationReport::violationCount() const {
  return commands.angle_violations + commands.thrust_violations + commands.yaw_rate_violations +
         commands.not_finite;
}

ValidationReport validate(const FlightLog& log, const std::vector<ReplaySample>& samples,
                          const AxisMaps& maps, const MultirotorOptions& options) {
  ValidationReport report;
  report.source = log.source;
  report.samples = samples.size();
  if (!samples.empty()) report.duration = samples.back().state.stamp - samples.front().state.stamp;
  validateTracking(samples, &report);
  std::vector<double> lookups;
  for (std::size_t axis = 0; axis < maps.size(); ++axis) {
    report.axes[axis] = validateAxis(samples, *maps[axis], axis);
    const std::vector<double>& times = report.axes[axis].lookups.in_order;
    lookups.insert(lookups.end(), times.begin(), times.end());
  }
  report.lookup_ns = percentiles(lookups);
  report.commands = validateCommands(log, samples, options);
  report.statuses = validateStatuses(log, samples);
  report.hold = holdOffset(log, samples);
  return report;
}

}  // namespace polyfly
