#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "filter_words.hpp"
#include "report_page.hpp"

namespace polyfly {
namespace {

using FilterJson = nlohmann::ordered_json;

// Least and greatest distances are infinite where an axis never had a state, which JSON cannot say.
FilterJson finiteOrNull(double value) { return std::isfinite(value) ? FilterJson(value) : FilterJson(); }

FilterJson countsOf(const std::array<std::size_t, kFilterStatusCount>& counts) {
  FilterJson out;
  for (std::size_t i = 0; i < counts.size(); ++i) out[kFilterStatusNames[i]] = counts[i];
  return out;
}

FilterJson axisJson(const FilterAxisValidation& axis) {
  FilterJson out = {{"axis", kFilterAxes[axis.axis]}, {"problem", axis.problem}, {"changed", axis.changed}};
  out["changed_s"] = axis.changed_time;
  out["greatest_change_m_s2"] = axis.greatest_change;
  out["outside_s"] = axis.outside_time;
  out["first_outside_s"] = axis.first_outside ? FilterJson(*axis.first_outside) : FilterJson();
  out["map_without_answer_s"] = axis.unanswered_time;
  out["least_distance"] = finiteOrNull(axis.least_distance);
  out["least_distance_at_s"] = axis.least_distance_at;
  out["position_m"] = {finiteOrNull(axis.least[0]), finiteOrNull(axis.greatest[0])};
  out["velocity_m_s"] = {finiteOrNull(axis.least[1]), finiteOrNull(axis.greatest[1])};
  return out;
}

FilterJson actionJson(const FilterAction& action) {
  return {{"axis", kFilterAxes[action.axis]},
          {"from_s", action.from},
          {"to_s", action.to},
          {"changed", action.count},
          {"worst", kFilterStatusNames[static_cast<std::size_t>(action.status)]},
          {"change_m_s2", action.change},
          {"least_distance", finiteOrNull(action.distance)}};
}

FilterJson comparisonJson(const FilterComparison& comparison) {
  return {{"recorded", countsOf(comparison.recorded)},
          {"compared", comparison.compared},
          {"differing", comparison.differing},
          {"missing", comparison.missing},
          {"greatest_difference_m_s2", comparison.greatest_difference}};
}

std::size_t answerCount(const FilterValidation& validation) {
  std::size_t count = 0;
  for (const std::size_t answers : validation.replayed) count += answers;
  return count;
}

}  // namespace

std::string filterNumber(double value) { return number(value); }

std::string filterVerdict(const FilterValidation& validation) {
  return validation.hasPassed()
             ? "Passed: the state stayed in the safe set, and each period had a command and odometry"
             : "To be looked at";
}

std::string toJson(const FilterValidation& validation) {
  FilterJson out;
  out["verdict"] = validation.hasPassed() ? "passed" : "doubtful";
  out["findings"] = validation.findings;
  out["source"] = std::filesystem::path(validation.source).filename().string();
  out["duration_s"] = validation.duration;
  out["answers"] = answerCount(validation);
  out["replayed"] = countsOf(validation.replayed);
  out["period_s"] = validation.period;
  out["median_period_s"] = validation.median_period;
  out["early"] = validation.early;
  out["changed_s"] = validation.changed_time;
  out["without_command_s"] = validation.without_wish_time;
  out["without_odometry_s"] = validation.without_state_time;
  out["recording_whole"] = validation.share ? FilterJson(validation.share->isWhole()) : FilterJson();
  out["in_flight"] = validation.comparison ? comparisonJson(*validation.comparison) : FilterJson();
  out["axes"] = FilterJson::array();
  for (const FilterAxisValidation& axis : validation.axes) out["axes"].push_back(axisJson(axis));
  out["actions"] = FilterJson::array();
  for (const FilterAction& action : validation.actions) out["actions"].push_back(actionJson(action));
  return out.dump(2) + "\n";
}

std::string toText(const FilterValidation& validation) {
  std::ostringstream out;
  out << validation.source << ": " << answerCount(validation) << " answers in " << number(validation.duration)
      << " s, " << validation.early << " commands came too soon\n";
  for (const FilterAxisValidation& axis : validation.axes) {
    out << "  " << kFilterAxes[axis.axis] << " (" << axis.problem << "): changed for "
        << number(axis.changed_time) << " s, by up to " << number(axis.greatest_change)
        << " m/s^2; outside of the safe set for " << number(axis.outside_time)
        << " s; least distance to its edge " << number(axis.least_distance) << " at "
        << number(axis.least_distance_at) << " s\n";
  }
  if (validation.comparison) {
    out << "  in flight: " << validation.comparison->compared << " answers compared, "
        << validation.comparison->differing << " differ, by up to "
        << number(validation.comparison->greatest_difference) << " m/s^2\n";
  } else {
    out << "  in flight: no filter_status was recorded, so nothing is compared\n";
  }
  out << filterVerdict(validation) << "\n";
  for (const std::string& finding : validation.findings) out << "  - " << finding << "\n";
  return out.str();
}

}  // namespace polyfly
