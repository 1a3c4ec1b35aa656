#include "validation/filter_validation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>

#include "polyfly_base/quantile.hpp"

namespace polyfly {
namespace {

// Changes of one axis that are less than so many periods apart are one action.
constexpr double kActionGap = 2.5;
// Greatest difference of an input that rounding explains [m/s^2].
constexpr double kSameInput = 1e-9;
// From this share on, statuses that the recorder missed are a finding.
constexpr double kGreatestMissing = 0.05;
// Greatest part by which answers may come more often or less often than the maps' period says.
constexpr double kPeriodTolerance = 0.2;

std::string seconds(double time) { return number(time) + " s"; }

FilterAxisValidation emptyAxis(const SafetyFilterProblem& problem, std::size_t axis) {
  FilterAxisValidation result;
  result.axis = axis;
  result.problem = problem.name;
  result.least_distance = result.least[0] = result.least[1] = std::numeric_limits<double>::infinity();
  result.greatest[0] = result.greatest[1] = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < 2; ++k) result.range[k] = {problem.states[k].lower, problem.states[k].upper};
  result.input_range = {problem.inputs[0].lower, problem.inputs[0].upper};
  return result;
}

void addAnswer(const FilterSample& sample, double time, FilterAxisValidation* axis) {
  const FilterAxisReport& report = sample.report.axes[axis->axis];
  if (report.status == FilterStatus::kNoState) return;
  if (report.input != report.wish) {
    ++axis->changed;
    axis->changed_time += sample.held;
    axis->greatest_change = std::max(axis->greatest_change, std::abs(report.input - report.wish));
  }
  if (report.status == FilterStatus::kOutside) axis->unanswered_time += sample.held;
  const double distance = sample.distance[axis->axis];
  if (distance < 0.0) {
    axis->outside_time += sample.held;
    if (!axis->first_outside) axis->first_outside = time;
  }
  if (distance < axis->least_distance) {
    axis->least_distance = distance;
    axis->least_distance_at = time;
  }
  const auto at = static_cast<Eigen::Index>(axis->axis);
  const double values[] = {sample.state.position[at], sample.state.velocity[at]};
  for (std::size_t k = 0; k < 2; ++k) {
    axis->least[k] = std::min(axis->least[k], values[k]);
    axis->greatest[k] = std::max(axis->greatest[k], values[k]);
  }
}

// The changes of one axis as stretches of time.
std::vector<FilterAction> actionsOf(const FilterReplay& replay, std::size_t axis, double period) {
  std::vector<FilterAction> actions;
  const double start = replay.samples.front().time;
  for (const FilterSample& sample : replay.samples) {
    const FilterAxisReport& report = sample.report.axes[axis];
    if (report.status == FilterStatus::kNoState || report.input == report.wish) continue;
    const double time = sample.time - start, change = report.input - report.wish;
    if (actions.empty() || time - actions.back().to > kActionGap * period) {
      actions.push_back({axis, time, time, 0, report.status, 0.0, sample.distance[axis]});
    }
    FilterAction& action = actions.back();
    action.to = time + sample.held;
    ++action.count;
    action.status = std::max(action.status, report.status);
    if (std::abs(change) > std::abs(action.change)) action.change = change;
    action.distance = std::min(action.distance, sample.distance[axis]);
  }
  return actions;
}

FilterComparison compareRecord(const FilterLog& log, const FilterReplay& replay,
                               const CommandFilter& filter) {
  FilterComparison result;
  std::map<double, const FilterLog::Status*> by_stamp;
  for (const FilterLog::Status& status : log.statuses) {
    ++result.recorded[static_cast<std::size_t>(status.status)];
    by_stamp.emplace(status.stamp, &status);
  }
  for (const FilterSample& sample : replay.samples) {
    if (!sample.stamp) continue;
    const auto found = by_stamp.find(*sample.stamp);
    if (found == by_stamp.end()) {
      if (*sample.stamp > by_stamp.begin()->first && *sample.stamp < by_stamp.rbegin()->first)
        ++result.missing;
      continue;
    }
    ++result.compared;
    bool differs = found->second->status != sample.report.status;
    for (std::size_t axis = 0; axis < sample.report.axes.size(); ++axis) {
      if (filter.problem(axis) == nullptr) continue;
      const double difference = std::abs(found->second->input[axis] - sample.report.axes[axis].input);
      result.greatest_difference = std::max(result.greatest_difference, difference);
      differs = differs || !(difference <= kSameInput);
    }
    if (differs) ++result.differing;
  }
  return result;
}

void findInTheRecord(FilterValidation* validation) {
  const FilterComparison& comparison = *validation->comparison;
  if (comparison.compared == 0) {
    validation->findings.push_back("no recorded filter_status has the stamp of a command");
  } else if (comparison.differing > 0) {
    validation->findings.push_back(
        std::to_string(comparison.differing) + " of " + std::to_string(comparison.compared) +
        " recorded answers are not those of the replay: other maps or options, or another order of arrival");
  }
  const double missing = static_cast<double>(comparison.missing);
  if (missing > kGreatestMissing * (missing + static_cast<double>(comparison.compared)))
    validation->findings.push_back(std::to_string(comparison.missing) +
                                   " commands have no recorded filter_status");
}

double medianHeld(const FilterReplay& replay) {
  std::vector<double> held;
  for (const FilterSample& sample : replay.samples) held.push_back(sample.held);
  return quantileOf(std::move(held));
}

void findFaults(FilterValidation* validation) {
  std::vector<std::string>& findings = validation->findings;
  if (validation->share) {
    const std::string loss = lossSentence(*validation->share);
    if (!loss.empty()) findings.push_back(loss);
  }
  if (std::abs(validation->median_period - validation->period) > kPeriodTolerance * validation->period)
    findings.push_back("answers are " + seconds(validation->median_period) +
                       " apart in the median, but the maps are made for " + seconds(validation->period));
  for (const FilterAxisValidation& axis : validation->axes) {
    if (axis.first_outside) {
      findings.push_back(std::string(kFilterAxes[axis.axis]) +
                         ": the state was outside of the safe set for " + seconds(axis.outside_time) +
                         ", first at " + seconds(*axis.first_outside));
    }
  }
  if (validation->without_state_time > 0.0)
    findings.push_back("without odometry for " + seconds(validation->without_state_time));
  if (validation->without_wish_time > 0.0)
    findings.push_back("without a command for " + seconds(validation->without_wish_time));
  if (validation->comparison) findInTheRecord(validation);
}

}  // namespace

FilterValidation validateFilter(const FilterLog& log, const FilterReplay& replay,
                                const CommandFilter& filter) {
  FilterValidation result;
  result.source = log.source;
  result.share = log.share;
  result.early = replay.early;
  result.period = filter.period();
  result.median_period = medianHeld(replay);
  const double start = replay.samples.front().time;
  result.duration = replay.samples.back().time + replay.samples.back().held - start;
  for (std::size_t axis = 0; axis < kFilterAxes.size(); ++axis) {
    if (filter.problem(axis) != nullptr) result.axes.push_back(emptyAxis(*filter.problem(axis), axis));
  }
  for (const FilterSample& sample : replay.samples) {
    ++result.replayed[static_cast<std::size_t>(sample.report.status)];
    if (sample.report.status == FilterStatus::kNoState) {
      result.without_state_time += sample.held;
      continue;
    }
    // The status tells the worst of the axes, which may hide that there was no wish.
    if (!sample.wished) result.without_wish_time += sample.held;
    bool changed = false;
    for (FilterAxisValidation& axis : result.axes) {
      addAnswer(sample, sample.time - start, &axis);
      const FilterAxisReport& report = sample.report.axes[axis.axis];
      changed = changed || report.input != report.wish;
    }
    if (changed) result.changed_time += sample.held;
  }
  for (const FilterAxisValidation& axis : result.axes) {
    const std::vector<FilterAction> actions = actionsOf(replay, axis.axis, filter.period());
    result.actions.insert(result.actions.end(), actions.begin(), actions.end());
  }
  std::stable_sort(result.actions.begin(), result.actions.end(),
                   [](const FilterAction& one, const FilterAction& other) { return one.from < other.from; });
  if (!log.statuses.empty()) result.comparison = compareRecord(log, replay, filter);
  findFaults(&result);
  return result;
}

}  // namespace polyfly
