#include "validation/filter_validation.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "polyfly_base/quantile.hpp"

namespace polyfly {
namespace {

constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
// In the order of FilterStatus.
constexpr const char* kFilterStatuses[] = {"passed", "changed", "no_wish", "outside", "no_state"};
// Changes of one axis that are less than so many periods apart are one action.
constexpr double kActionGap = 2.5;
// Greatest difference of an input that rounding explains [m/s^2].
constexpr double kSameInput = 1e-9;
// From this share on, statuses that the recorder missed are a finding.
constexpr double kGreatestMissing = 0.05;
// Greatest part by which answers may come more often or less often than the maps' period says.
constexpr double kPeriodTolerance = 0.2;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

using Counts = std::array<std::size_t, std::size(kFilterStatuses)>;

std::string seconds(double time) { return number(time) + " s"; }

const char* nameOf(FilterStatus status) { return kFilterStatuses[static_cast<std::size_t>(status)]; }

Json countsOf(const Counts& counts) {
  Json out;
  for (std::size_t i = 0; i < counts.size(); ++i) out[kFilterStatuses[i]] = counts[i];
  return out;
}

// Least and greatest are infinite where an axis never had a state, which JSON cannot say.
Json finiteOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(); }

struct Extent {
  double least = kInfinity;
  double greatest = -kInfinity;

  void add(double value) {
    least = std::min(least, value);
    greatest = std::max(greatest, value);
  }
  Json json() const { return {finiteOrNull(least), finiteOrNull(greatest)}; }
};

// One axis of the world that has a map. Times count from the first answer.
Json axisOf(const FilterReplay& replay, const SafetyFilterProblem& problem, std::size_t axis) {
  const auto at = static_cast<Eigen::Index>(axis);
  std::size_t changed = 0;
  double changed_time = 0.0, greatest_change = 0.0, outside_time = 0.0, unanswered_time = 0.0;
  double least_distance = kInfinity, least_distance_at = 0.0;
  Json first_outside;
  Extent position, velocity;
  for (const FilterSample& sample : replay.samples) {
    const FilterAxisReport& report = sample.report.axes[axis];
    if (sample.report.status == FilterStatus::kNoState || report.status == FilterStatus::kNoState) continue;
    const double time = sample.time - replay.samples.front().time;
    if (report.input != report.wish) {
      ++changed;
      changed_time += sample.held;
      greatest_change = std::max(greatest_change, std::abs(report.input - report.wish));
    }
    if (report.status == FilterStatus::kOutside) unanswered_time += sample.held;
    const double distance = sample.distance[axis];
    if (distance < 0.0) {
      outside_time += sample.held;
      if (first_outside.is_null()) first_outside = time;
    }
    if (distance < least_distance) {
      least_distance = distance;
      least_distance_at = time;
    }
    position.add(sample.state.position[at]);
    velocity.add(sample.state.velocity[at]);
  }
  return {{"axis", kAxes[axis]},
          {"problem", problem.name},
          {"changed", changed},
          {"changed_s", changed_time},
          {"greatest_change_m_s2", greatest_change},
          {"outside_s", outside_time},
          {"first_outside_s", first_outside},
          {"map_without_answer_s", unanswered_time},
          {"least_distance", finiteOrNull(least_distance)},
          {"least_distance_at_s", least_distance_at},
          {"position_m", position.json()},
          {"velocity_m_s", velocity.json()}};
}

// A stretch of time in which the filter changed the commands of one axis.
struct Action {
  double from = 0.0;      // since the first answer [s]
  double to = 0.0;        // since the first answer [s]
  std::size_t count = 0;  // changed commands
  FilterStatus worst = FilterStatus::kChanged;
  double change = 0.0;    // of the greatest size, sent minus wished [m/s^2]
  double distance = 0.0;  // least; see edgeDistance
};

void addActions(const FilterReplay& replay, std::size_t axis, double period, Json* all) {
  std::vector<Action> actions;
  for (const FilterSample& sample : replay.samples) {
    const FilterAxisReport& report = sample.report.axes[axis];
    if (report.status == FilterStatus::kNoState || report.input == report.wish) continue;
    const double time = sample.time - replay.samples.front().time, change = report.input - report.wish;
    if (actions.empty() || time - actions.back().to > kActionGap * period)
      actions.push_back({time, time, 0, report.status, 0.0, sample.distance[axis]});
    Action& action = actions.back();
    action.to = time + sample.held;
    ++action.count;
    action.worst = std::max(action.worst, report.status);
    if (std::abs(change) > std::abs(action.change)) action.change = change;
    action.distance = std::min(action.distance, sample.distance[axis]);
  }
  for (const Action& action : actions)
    all->push_back({{"axis", kAxes[axis]},
                    {"from_s", action.from},
                    {"to_s", action.to},
                    {"changed", action.count},
                    {"worst", nameOf(action.worst)},
                    {"change_m_s2", action.change},
                    {"least_distance", finiteOrNull(action.distance)}});
}

// What was recorded in flight against the replay.
Json comparisonOf(const FilterLog& log, const FilterReplay& replay, const CommandFilter& filter) {
  Counts recorded{};
  std::map<double, const FilterLog::Status*> by_stamp;
  for (const FilterLog::Status& status : log.statuses) {
    ++recorded[static_cast<std::size_t>(status.status)];
    by_stamp.emplace(status.stamp, &status);
  }
  // Commands between the first and the last recorded status that have none are missing.
  std::size_t compared = 0, differing = 0, missing = 0;
  double greatest_difference = 0.0;
  for (const FilterSample& sample : replay.samples) {
    if (!sample.stamp) continue;
    const auto found = by_stamp.find(*sample.stamp);
    if (found == by_stamp.end()) {
      if (*sample.stamp > by_stamp.begin()->first && *sample.stamp < by_stamp.rbegin()->first) ++missing;
      continue;
    }
    ++compared;
    bool differs = found->second->status != sample.report.status;
    for (std::size_t axis = 0; axis < sample.report.axes.size(); ++axis) {
      if (filter.problem(axis) == nullptr) continue;
      const double difference = std::abs(found->second->input[axis] - sample.report.axes[axis].input);
      greatest_difference = std::max(greatest_difference, difference);
      differs = differs || !(difference <= kSameInput);
    }
    if (differs) ++differing;
  }
  return {{"recorded", countsOf(recorded)},
          {"compared", compared},
          {"differing", differing},
          {"missing", missing},
          {"greatest_difference_m_s2", greatest_difference}};
}

// Counts the answers, and adds up the times in which something was changed or lacking.
void addTimes(const FilterReplay& replay, const CommandFilter& filter, Json* out) {
  Counts replayed{};
  double changed = 0.0, without_wish = 0.0, without_state = 0.0;
  std::vector<double> held;
  for (const FilterSample& sample : replay.samples) {
    ++replayed[static_cast<std::size_t>(sample.report.status)];
    held.push_back(sample.held);
    if (sample.report.status == FilterStatus::kNoState) {
      without_state += sample.held;
      continue;
    }
    // The status tells the worst of the axes, which may hide that there was no wish.
    if (!sample.wished) without_wish += sample.held;
    for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
      const FilterAxisReport& report = sample.report.axes[axis];
      if (filter.problem(axis) == nullptr || report.input == report.wish) continue;
      changed += sample.held;
      break;
    }
  }
  const FilterSample &first = replay.samples.front(), &last = replay.samples.back();
  (*out)["duration_s"] = last.time + last.held - first.time;
  (*out)["answers"] = replay.samples.size();
  (*out)["replayed"] = countsOf(replayed);
  (*out)["period_s"] = filter.period();
  (*out)["median_period_s"] = quantileOf(std::move(held));
  (*out)["early"] = replay.early;
  (*out)["changed_s"] = changed;
  (*out)["without_command_s"] = without_wish;
  (*out)["without_odometry_s"] = without_state;
}

void findInTheRecord(const Json& record, std::vector<std::string>* findings) {
  const auto compared = record["compared"].get<double>(), missing = record["missing"].get<double>();
  if (compared == 0.0) {
    findings->push_back("no recorded filter_status has the stamp of a command");
  } else if (record["differing"] > 0) {
    findings->push_back(
        record["differing"].dump() + " of " + record["compared"].dump() +
        " recorded answers are not those of the replay: other maps or options, or another order of arrival");
  }
  if (missing > kGreatestMissing * (missing + compared))
    findings->push_back(record["missing"].dump() + " commands have no recorded filter_status");
}

std::vector<std::string> findingsOf(const std::optional<RecordingShare>& share, const Json& judged) {
  std::vector<std::string> findings;
  const std::string loss = share ? lossSentence(*share) : "";
  if (!loss.empty()) findings.push_back(loss);
  const auto period = judged["period_s"].get<double>(), median = judged["median_period_s"].get<double>();
  if (std::abs(median - period) > kPeriodTolerance * period)
    findings.push_back("answers are " + seconds(median) + " apart in the median, but the maps are made for " +
                       seconds(period));
  for (const Json& axis : judged["axes"]) {
    if (axis["first_outside_s"].is_null()) continue;
    findings.push_back(wordsOn(axis["axis"]) + ": the state was outside of the safe set for " +
                       seconds(axis["outside_s"]) + ", first at " + seconds(axis["first_outside_s"]));
  }
  if (judged["without_odometry_s"] > 0.0)
    findings.push_back("without odometry for " + seconds(judged["without_odometry_s"]));
  if (judged["without_command_s"] > 0.0)
    findings.push_back("without a command for " + seconds(judged["without_command_s"]));
  if (!judged["in_flight"].is_null()) findInTheRecord(judged["in_flight"], &findings);
  return findings;
}

}  // namespace

Json judgeFilter(const FilterLog& log, const FilterReplay& replay, const CommandFilter& filter) {
  Json out = {{"verdict", ""}, {"findings", Json::array()}, {"source", fileName(log.source)}};
  addTimes(replay, filter, &out);
  out["recording_whole"] = log.share ? Json(log.share->isWhole()) : Json();
  out["in_flight"] = log.statuses.empty() ? Json() : comparisonOf(log, replay, filter);
  out["axes"] = Json::array();
  out["actions"] = Json::array();
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
    if (filter.problem(axis) == nullptr) continue;
    out["axes"].push_back(axisOf(replay, *filter.problem(axis), axis));
    addActions(replay, axis, filter.period(), &out["actions"]);
  }
  std::stable_sort(out["actions"].begin(), out["actions"].end(),
                   [](const Json& one, const Json& other) { return one["from_s"] < other["from_s"]; });
  const std::vector<std::string> findings = findingsOf(log.share, out);
  out["findings"] = findings;
  out["verdict"] = findings.empty() ? "passed" : "doubtful";
  return out;
}

}  // namespace polyfly
