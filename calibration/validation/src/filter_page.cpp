#include <algorithm>
#include <cmath>
#include <utility>

#include "report/figures.hpp"
#include "validation/filter_validation.hpp"

namespace polyfly {
namespace {

using Fault = ReportColumn::Rule;

// Actions beyond these are in the summary only.
constexpr std::size_t kListedActions = 40;
constexpr const char* kOutsideColor = "#fbe6da";
constexpr std::array<const char*, kFilterStatusCount> kFilterStatusNames = {"passed", "changed", "no_wish",
                                                                            "outside", "no_state"};

// Least and greatest distances are infinite where an axis never had a state, which JSON cannot say.
Json finiteOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json countsOf(const std::array<std::size_t, kFilterStatusCount>& counts) {
  Json out;
  for (std::size_t i = 0; i < counts.size(); ++i) out[kFilterStatusNames[i]] = counts[i];
  return out;
}

Json json(const FilterAxisValidation& axis) {
  return {{"axis", kFilterAxes[axis.axis]},
          {"problem", axis.problem},
          {"changed", axis.changed},
          {"changed_s", axis.changed_time},
          {"greatest_change_m_s2", axis.greatest_change},
          {"outside_s", axis.outside_time},
          {"first_outside_s", axis.first_outside ? Json(*axis.first_outside) : Json()},
          {"map_without_answer_s", axis.unanswered_time},
          {"least_distance", finiteOrNull(axis.least_distance)},
          {"least_distance_at_s", axis.least_distance_at},
          {"position_m", {finiteOrNull(axis.least[0]), finiteOrNull(axis.greatest[0])}},
          {"velocity_m_s", {finiteOrNull(axis.least[1]), finiteOrNull(axis.greatest[1])}}};
}

Json json(const FilterAction& action) {
  return {{"axis", kFilterAxes[action.axis]},
          {"from_s", action.from},
          {"to_s", action.to},
          {"changed", action.count},
          {"worst", kFilterStatusNames[static_cast<std::size_t>(action.status)]},
          {"change_m_s2", action.change},
          {"least_distance", finiteOrNull(action.distance)}};
}

Json json(const FilterComparison& comparison) {
  return {{"recorded", countsOf(comparison.recorded)},
          {"compared", comparison.compared},
          {"differing", comparison.differing},
          {"missing", comparison.missing},
          {"greatest_difference_m_s2", comparison.greatest_difference}};
}

std::vector<ReportTile> tilesOn(const FilterValidation& validation) {
  double outside = 0.0, change = 0.0, distance = kNothing;
  for (const FilterAxisValidation& axis : validation.axes) {
    outside = std::max(outside, axis.outside_time);
    change = std::max(change, axis.greatest_change);
    distance = std::fmin(distance, axis.least_distance);
  }
  const auto seconds = [](double time) { return number(time) + " s"; };
  std::vector<ReportTile> tiles = {
      {seconds(validation.duration), "replayed"},
      {seconds(validation.changed_time), "in which commands were changed"},
      {number(change) + " m/s²", "greatest change of an axis"},
      {number(distance), "least distance to the edge of a safe set", !(distance < 0.0)},
      {seconds(outside), "outside of a safe set, on the worst axis", outside == 0.0},
      {seconds(validation.without_wish_time), "without a command", validation.without_wish_time == 0.0},
      {seconds(validation.without_state_time), "without odometry", validation.without_state_time == 0.0},
      {std::to_string(validation.early), "commands that came too soon"}};
  if (validation.comparison)
    tiles.push_back({std::to_string(validation.comparison->differing),
                     "recorded answers that differ, of " + std::to_string(validation.comparison->compared),
                     validation.comparison->differing == 0});
  return tiles;
}

ReportSection axesSection(const Json& axes) {
  return {
      "The axes in numbers",
      {"Axes of the world. States count in halves of their ranges for the distance to the edge of the safe "
       "set; it is negative outside."},
      {},
      tableOf(axes, {{"axis", "/axis"},
                     {"problem", "/problem"},
                     {"changed", "/changed"},
                     {"changed [s]", "/changed_s"},
                     {"greatest change [m/s²]", "/greatest_change_m_s2"},
                     {"outside [s]", "/outside_s", Fault::kZero},
                     {"map without an answer [s]", "/map_without_answer_s"},
                     {"least distance", "/least_distance"},
                     {"at [s]", "/least_distance_at_s"},
                     {"position [m]", "/position_m"},
                     {"velocity [m/s]", "/velocity_m_s"}}),
      {}};
}

ReportSection actionsSection(Json actions) {
  ReportSection section = {"Where the filter acted"};
  if (actions.empty()) {
    section.sentences = {"Nowhere: each command was sent as it came."};
    return section;
  }
  section.sentences = {
      "Each stretch of changed commands, with the greatest difference between what was sent and what was "
      "wished."};
  if (actions.size() > kListedActions) {
    section.sentences.push_back(std::to_string(actions.size() - kListedActions) +
                                " more are in summary.json.");
    actions.get_ref<Json::array_t&>().resize(kListedActions);
  }
  section.table = tableOf(actions, {{"axis", "/axis"},
                                    {"from [s]", "/from_s"},
                                    {"to [s]", "/to_s"},
                                    {"changed", "/changed"},
                                    {"sent − wished [m/s²]", "/change_m_s2"},
                                    {"least distance", "/least_distance"},
                                    {"worst", "/worst"}});
  return section;
}

// A panel over the answers; each curve has a label, a colour and a value for a sample.
class FilterPanels {
 public:
  FilterPanels(const FilterValidation& validation, const FilterReplay& replay, std::size_t axis)
      : replay_(replay) {
    for (const FilterAction& action : validation.actions) {
      if (action.axis != axis) continue;
      bands_.push_back({action.from, action.to});
      if (action.status >= FilterStatus::kOutside) bands_.back().color = kOutsideColor;
    }
  }

  void add(const std::string& label, std::vector<Rule> bounds) {
    panels_.push_back(timePanel("", label));
    panels_.back().bands = bands_;
    panels_.back().bounds = std::move(bounds);
  }

  template <class Value>
  void draw(const std::string& label, const std::string& color, Value value) {
    Series series;
    series.label = label;
    series.color = color;
    for (const FilterSample& sample : replay_.samples) {
      series.x.push_back(sample.time - replay_.samples.front().time);
      series.y.push_back(sample.report.status == FilterStatus::kNoState ? kNothing : value(sample));
    }
    panels_.back().series.push_back(thinned(withGaps(series), kCurvePoints));
  }

  std::vector<Panel> take() { return std::move(panels_); }

 private:
  const FilterReplay& replay_;
  std::vector<Band> bands_;
  std::vector<Panel> panels_;
};

ReportSection filterFigure(const FilterValidation& validation, const FilterAxisValidation& axis,
                           const FilterReplay& replay) {
  const std::size_t i = axis.axis;
  const auto at = static_cast<Eigen::Index>(i);
  FilterPanels panels(validation, replay, i);
  panels.add("acceleration [m/s²]", {{axis.input_range[0], ""}, {axis.input_range[1], ""}});
  panels.draw("wish", kMeasuredColor, [i](const FilterSample& one) { return one.report.axes[i].wish; });
  panels.draw("sent", palette::kBlue, [i](const FilterSample& one) { return one.report.axes[i].input; });
  panels.add("position [m]", {{axis.range[0][0], ""}, {axis.range[0][1], ""}});
  panels.draw("", palette::kBlue, [at](const FilterSample& one) { return one.state.position[at]; });
  panels.add("velocity [m/s]", {{axis.range[1][0], ""}, {axis.range[1][1], ""}});
  panels.draw("", palette::kBlue, [at](const FilterSample& one) { return one.state.velocity[at]; });
  panels.add("distance to the edge", {{0.0, "edge"}});
  panels.draw("", palette::kGreen, [i](const FilterSample& one) { return one.distance[i]; });
  return pictured(
      std::string("Axis ") + kFilterAxes[i] + ": " + axis.problem,
      "Wish and answer with the input's limits, position and velocity with the ranges that the "
      "filter keeps, and the distance to the edge of the safe set. Shaded: the filter changed the "
      "command; darker: the map had no answer.",
      panels.take(), row_height::kStacked);
}

}  // namespace

Json jsonOf(const FilterValidation& validation) {
  std::size_t answers = 0;
  for (const std::size_t count : validation.replayed) answers += count;
  Json out = {{"verdict", validation.hasPassed() ? "passed" : "doubtful"},
              {"findings", validation.findings},
              {"source", fileName(validation.source)},
              {"duration_s", validation.duration},
              {"answers", answers},
              {"replayed", countsOf(validation.replayed)},
              {"period_s", validation.period},
              {"median_period_s", validation.median_period},
              {"early", validation.early},
              {"changed_s", validation.changed_time},
              {"without_command_s", validation.without_wish_time},
              {"without_odometry_s", validation.without_state_time},
              {"recording_whole", validation.share ? Json(validation.share->isWhole()) : Json()},
              {"in_flight", validation.comparison ? json(*validation.comparison) : Json()},
              {"axes", Json::array()},
              {"actions", Json::array()}};
  for (const FilterAxisValidation& axis : validation.axes) out["axes"].push_back(json(axis));
  for (const FilterAction& action : validation.actions) out["actions"].push_back(json(action));
  return out;
}

Report reportOn(const FilterValidation& validation) {
  const Json json = jsonOf(validation);
  Report page;
  page.title = "Replay of a safety filter";
  page.sources = {wordsOn(json["source"])};
  page.good = validation.hasPassed();
  page.verdict = page.good
                     ? "Passed: the state stayed in the safe set, and each period had a command and odometry"
                     : "To be looked at";
  page.reasons = validation.findings;
  page.tiles = tilesOn(validation);
  page.sections = {axesSection(json["axes"]), actionsSection(json["actions"])};
  page.sections.push_back(
      {"What this page can tell",
       {"Answers of the replay: " + wordsOn(json["replayed"]) + ".",
        validation.comparison
            ? "The filter flew, so the states of the record are those that its answers led to."
            : "The filter did not fly: where it would have changed a command, the flight went on with "
              "another one. States outside of the safe set are then no fault of the filter."}});
  return page;
}

void writeFilterReport(const FilterValidation& validation, const FilterReplay& replay,
                       const std::string& folder) {
  Report page = reportOn(validation);
  for (const FilterAxisValidation& axis : validation.axes)
    page.sections.push_back(filterFigure(validation, axis, replay));
  writePage(folder, page, "summary.json", dumped(jsonOf(validation)));
}

}  // namespace polyfly
