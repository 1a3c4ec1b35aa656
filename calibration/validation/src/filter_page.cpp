#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "filter_words.hpp"
#include "report_page.hpp"
#include "report_parts.hpp"

namespace polyfly {
namespace {

// Actions beyond these are in the summary only.
constexpr std::size_t kListedActions = 40;
constexpr const char* kOutsideColor = "#fbe6da";

void filterTile(const std::string& value, const std::string& label, bool good, std::ostream& out) {
  out << "<div class='tile" << (good ? "" : " bad") << "'><b>" << escaped(value) << "</b><span>"
      << escaped(label) << "</span></div>\n";
}

void writeFilterTiles(const FilterValidation& validation, std::ostream& out) {
  double outside = 0.0, change = 0.0, distance = kNothing;
  for (const FilterAxisValidation& axis : validation.axes) {
    outside = std::max(outside, axis.outside_time);
    change = std::max(change, axis.greatest_change);
    distance = std::fmin(distance, axis.least_distance);
  }
  out << "<div class='tiles'>\n";
  filterTile(number(validation.duration) + " s", "replayed", true, out);
  filterTile(number(validation.changed_time) + " s", "in which commands were changed", true, out);
  filterTile(number(change) + " m/s²", "greatest change of an axis", true, out);
  filterTile(number(distance), "least distance to the edge of a safe set", !(distance < 0.0), out);
  filterTile(number(outside) + " s", "outside of a safe set, on the worst axis", outside == 0.0, out);
  filterTile(number(validation.without_wish_time) + " s", "without a command",
             validation.without_wish_time == 0.0, out);
  filterTile(number(validation.without_state_time) + " s", "without odometry",
             validation.without_state_time == 0.0, out);
  if (validation.comparison) {
    filterTile(std::to_string(validation.comparison->differing),
               "recorded answers that differ, of " + std::to_string(validation.comparison->compared),
               validation.comparison->differing == 0, out);
  }
  out << "</div>\n";
}

void writeFilterAxes(const FilterValidation& validation, std::ostream& out) {
  out << "<section><h2>The axes in numbers</h2><p>Axes of the world. States count in halves of their ranges "
         "for the "
         "distance to the edge of the safe set; it is negative outside.</p><div class='scroll'><table "
         "class='numbers'>"
         "<tr><th>axis</th><th>changed</th><th>changed [s]</th><th>greatest change [m/s²]</th><th>outside "
         "[s]</th>"
         "<th>map without an answer [s]</th><th>least distance</th><th>at [s]</th><th>position [m]</th>"
         "<th>velocity [m/s]</th></tr>\n";
  for (const FilterAxisValidation& axis : validation.axes) {
    out << (axis.outside_time > 0.0 ? "<tr class='bad'>" : "<tr>") << "<td>" << kFilterAxes[axis.axis] << ", "
        << escaped(axis.problem) << "</td><td>" << axis.changed << "</td><td>" << number(axis.changed_time)
        << "</td><td>" << number(axis.greatest_change) << "</td><td>" << number(axis.outside_time)
        << "</td><td>" << number(axis.unanswered_time) << "</td><td>" << number(axis.least_distance)
        << "</td><td>" << number(axis.least_distance_at) << "</td>";
    for (std::size_t k = 0; k < 2; ++k)
      out << "<td>" << number(axis.least[k]) << " .. " << number(axis.greatest[k]) << "</td>";
    out << "</tr>\n";
  }
  out << "</table></div></section>\n";
}

void writeFilterActions(const FilterValidation& validation, std::ostream& out) {
  out << "<section><h2>Where the filter acted</h2>";
  if (validation.actions.empty()) {
    out << "<p>Nowhere: each command was sent as it came.</p></section>\n";
    return;
  }
  out << "<p>Each stretch of changed commands, with the greatest difference between what was sent and what "
         "was wished.</p>"
         "<div class='scroll'><table class='numbers'><tr><th>axis</th><th>from [s]</th><th>to [s]</th>"
         "<th>changed</th><th>sent − wished [m/s²]</th><th>least distance</th><th>worst</th></tr>\n";
  for (std::size_t i = 0; i < std::min(kListedActions, validation.actions.size()); ++i) {
    const FilterAction& action = validation.actions[i];
    out << (action.status >= FilterStatus::kOutside ? "<tr class='bad'>" : "<tr>") << "<td>"
        << kFilterAxes[action.axis] << "</td><td>" << number(action.from, 4) << "</td><td>"
        << number(action.to, 4) << "</td><td>" << action.count << "</td><td>" << number(action.change)
        << "</td><td>" << number(action.distance) << "</td><td>"
        << kFilterStatusNames[static_cast<std::size_t>(action.status)] << "</td></tr>\n";
  }
  out << "</table></div>";
  if (validation.actions.size() > kListedActions)
    out << "<p>" << validation.actions.size() - kListedActions << " more are in summary.json.</p>";
  out << "</section>\n";
}

template <class Value>
Series filterCurve(const FilterReplay& replay, const std::string& label, const std::string& color,
                   Value value) {
  Series series;
  series.label = label;
  series.color = color;
  for (const FilterSample& sample : replay.samples) {
    series.x.push_back(sample.time - replay.samples.front().time);
    series.y.push_back(sample.report.status == FilterStatus::kNoState ? kNothing : value(sample));
  }
  return thinned(withGaps(series), kCurvePoints);
}

std::vector<Band> actionBands(const FilterValidation& validation, std::size_t axis) {
  std::vector<Band> bands;
  for (const FilterAction& action : validation.actions) {
    if (action.axis != axis) continue;
    bands.push_back({action.from, action.to});
    if (action.status >= FilterStatus::kOutside) bands.back().color = kOutsideColor;
  }
  return bands;
}

ReportFigure filterFigure(const FilterValidation& validation, const FilterAxisValidation& axis,
                          const FilterReplay& replay) {
  const std::size_t i = axis.axis;
  const auto at = static_cast<Eigen::Index>(i);
  ReportFigure result;
  result.heading = std::string("Axis ") + kFilterAxes[i] + ": " + axis.problem;
  result.caption =
      "Wish and answer with the input's limits, position and velocity with the ranges that the filter keeps, "
      "and the "
      "distance to the edge of the safe set. Shaded: the filter changed the command; darker: the map had no "
      "answer.";
  Panel input = timePanel("", "acceleration [m/s²]");
  input.series = {filterCurve(replay, "wish", kMeasuredColor,
                              [i](const FilterSample& sample) { return sample.report.axes[i].wish; }),
                  filterCurve(replay, "sent", palette::kBlue,
                              [i](const FilterSample& sample) { return sample.report.axes[i].input; })};
  input.bounds = {{axis.input_range[0], ""}, {axis.input_range[1], ""}};
  Panel position = timePanel("", "position [m]");
  position.series = {filterCurve(replay, "", palette::kBlue,
                                 [at](const FilterSample& sample) { return sample.state.position[at]; })};
  Panel velocity = timePanel("", "velocity [m/s]");
  velocity.series = {filterCurve(replay, "", palette::kBlue,
                                 [at](const FilterSample& sample) { return sample.state.velocity[at]; })};
  position.bounds = {{axis.range[0][0], ""}, {axis.range[0][1], ""}};
  velocity.bounds = {{axis.range[1][0], ""}, {axis.range[1][1], ""}};
  Panel distance = timePanel("", "distance to the edge");
  distance.series = {filterCurve(replay, "", palette::kGreen,
                                 [i](const FilterSample& sample) { return sample.distance[i]; })};
  distance.bounds = {{0.0, "edge"}};
  std::vector<Panel> panels = {input, position, velocity, distance};
  for (Panel& panel : panels) panel.bands = actionBands(validation, i);
  result.figure = pageFigure(std::move(panels), row_height::kStacked);
  return result;
}

}  // namespace

std::string toHtml(const FilterValidation& validation, const FilterReplay& replay) {
  std::ostringstream out;
  out << "<!DOCTYPE html>\n<html lang='en'><head><meta charset='utf-8'><meta name='viewport' "
         "content='width=device-width, initial-scale=1'><title>Replay of a safety filter</title><style>"
      << kReportStyle << "</style></head><body><main>\n<h1>Replay of a safety filter</h1>\n<p class='source'>"
      << escaped(std::filesystem::path(validation.source).filename().string()) << "</p>\n<div class='verdict "
      << (validation.hasPassed() ? "good" : "bad") << "'>" << escaped(filterVerdict(validation));
  if (!validation.hasPassed()) {
    out << "<ul>";
    for (const std::string& finding : validation.findings) out << "<li>" << escaped(finding) << "</li>";
    out << "</ul>";
  }
  out << "</div>\n";
  writeFilterTiles(validation, out);
  writeFilterAxes(validation, out);
  writeFilterActions(validation, out);
  for (const FilterAxisValidation& axis : validation.axes)
    writeFigureSection(filterFigure(validation, axis, replay), out);
  out << "<section><h2>What this page can tell</h2><p>States are those of the record. ";
  out << (validation.comparison ? "The filter flew, so they are those that its answers led to."
                                : "The filter did not fly: where it would have changed a command, the flight "
                                  "went on with another one. "
                                  "States outside of the safe set are then no fault of the filter.");
  out << "</p></section>\n" << kPageEnd;
  return out.str();
}

void writeFilterReport(const FilterValidation& validation, const FilterReplay& replay,
                       const std::string& folder) {
  writePage(folder, toHtml(validation, replay), "summary.json", toJson(validation));
}

}  // namespace polyfly
