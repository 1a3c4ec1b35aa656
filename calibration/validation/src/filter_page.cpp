#include <cmath>
#include <string>
#include <utility>

#include "report/figures.hpp"
#include "validation/filter_validation.hpp"

namespace polyfly {
namespace {

// Actions beyond these are in the summary only.
constexpr std::size_t kListedActions = 40;
constexpr const char* kOutsideColor = "#fbe6da";

// The greatest of a number of all axes; that with the other sign is the least.
double worstOf(const Json& axes, const char* key, double sign) {
  double worst = kNothing;
  for (const Json& axis : axes) {
    if (!axis[key].is_null()) worst = std::fmax(worst, sign * axis[key].get<double>());
  }
  return sign * worst;
}

std::vector<ReportTile> tilesOn(const Json& judged) {
  const double distance = worstOf(judged["axes"], "least_distance", -1.0);
  const double outside = worstOf(judged["axes"], "outside_s", 1.0);
  const auto seconds = [](const Json& time) { return wordsOn(time) + " s"; };
  std::vector<ReportTile> tiles = {
      {seconds(judged["duration_s"]), "replayed"},
      {seconds(judged["changed_s"]), "in which commands were changed"},
      {number(worstOf(judged["axes"], "greatest_change_m_s2", 1.0)) + " m/s²", "greatest change of an axis"},
      {number(distance), "least distance to the edge of a safe set", !(distance < 0.0)},
      {seconds(outside), "outside of a safe set, on the worst axis", outside == 0.0},
      {seconds(judged["without_command_s"]), "without a command", judged["without_command_s"] == 0.0},
      {seconds(judged["without_odometry_s"]), "without odometry", judged["without_odometry_s"] == 0.0},
      {wordsOn(judged["early"]), "commands that came too soon"}};
  const Json& record = judged["in_flight"];
  if (!record.is_null())
    tiles.push_back({wordsOn(record["differing"]),
                     "recorded answers that differ, of " + wordsOn(record["compared"]),
                     record["differing"] == 0});
  return tiles;
}

ReportSection filterAxesSection(const Json& axes) {
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
                     {"outside [s]", "/outside_s", ReportColumn::Rule::kZero},
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

ReportSection filterFigure(const Json& judged, const FilterReplay& replay, const SafetyFilterProblem& problem,
                           std::size_t axis) {
  const auto at = static_cast<Eigen::Index>(axis);
  const std::string name(1, "xyz"[axis]);
  std::vector<Band> bands;
  for (const Json& action : judged["actions"]) {
    if (action["axis"] != name) continue;
    bands.push_back({action["from_s"], action["to_s"]});
    if (action["worst"] == "outside") bands.back().color = kOutsideColor;
  }
  std::vector<Panel> panels;
  const auto add = [&](const std::string& label, double lower, double upper) {
    panels.push_back(timePanel("", label));
    panels.back().bands = bands;
    panels.back().bounds = {{lower, ""}, {upper, ""}};
  };
  const auto draw = [&](const std::string& label, const std::string& color, auto value) {
    panels.back().series.push_back(
        curve(label, color, replay.samples.front().time, replay.samples, [&](const FilterSample& one) {
          const bool is_known = one.report.status != FilterStatus::kNoState;
          return std::make_pair(one.time, is_known ? value(one) : kNothing);
        }));
  };
  add("acceleration [m/s²]", problem.inputs[0].lower, problem.inputs[0].upper);
  draw("wish", kMeasuredColor, [axis](const FilterSample& one) { return one.report.axes[axis].wish; });
  draw("sent", palette::kBlue, [axis](const FilterSample& one) { return one.report.axes[axis].input; });
  add("position [m]", problem.states[0].lower, problem.states[0].upper);
  draw("", palette::kBlue, [at](const FilterSample& one) { return one.state.position[at]; });
  add("velocity [m/s]", problem.states[1].lower, problem.states[1].upper);
  draw("", palette::kBlue, [at](const FilterSample& one) { return one.state.velocity[at]; });
  add("distance to the edge", 0.0, 0.0);
  draw("", palette::kGreen, [axis](const FilterSample& one) { return one.distance[axis]; });
  return pictured(
      "Axis " + name + ": " + problem.name,
      "Wish and answer with the input's limits, position and velocity with the ranges that the "
      "filter keeps, and the distance to the edge of the safe set. Shaded: the filter changed the "
      "command; darker: the map had no answer.",
      panels, row_height::kStacked);
}

}  // namespace

Report reportOnFilter(const Json& judged) {
  Report page;
  page.title = "Replay of a safety filter";
  page.sources = {wordsOn(judged["source"])};
  page.good = judged["verdict"] == "passed";
  page.verdict = page.good
                     ? "Passed: the state stayed in the safe set, and each period had a command and odometry"
                     : "To be looked at";
  page.reasons = judged["findings"].get<std::vector<std::string>>();
  page.tiles = tilesOn(judged);
  page.sections = {filterAxesSection(judged["axes"]), actionsSection(judged["actions"])};
  page.sections.push_back(
      {"What this page can tell",
       {"Answers of the replay: " + wordsOn(judged["replayed"]) + ".",
        judged["in_flight"].is_null()
            ? "The filter did not fly: where it would have changed a command, the flight went on with "
              "another one. States outside of the safe set are then no fault of the filter."
            : "The filter flew, so the states of the record are those that its answers led to."}});
  return page;
}

void writeFilterReport(const Json& judgement, const FilterReplay& replay, const CommandFilter& filter,
                       const std::string& folder) {
  Report page = reportOnFilter(judgement);
  for (std::size_t axis = 0; axis < replay.samples.front().distance.size(); ++axis) {
    if (filter.problem(axis) != nullptr)
      page.sections.push_back(filterFigure(judgement, replay, *filter.problem(axis), axis));
  }
  writePage(folder, page, "summary.json", dumped(judgement));
}

}  // namespace polyfly
