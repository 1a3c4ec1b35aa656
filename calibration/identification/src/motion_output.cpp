#include "identification/motion_output.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "report/figures.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

using Fault = ReportColumn::Rule;

// Half width from which on the data say nothing, for any quantity here.
constexpr double kNoInterval = 1e4;

Json json(const DisturbanceBound& bound) {
  return {{"mean", bound.mean},
          {"deviation", bound.deviation},
          {"supported", bound.supported},
          {"confidence", bound.confidence},
          {"independent_samples", bound.independent_samples},
          {"warnings", bound.warnings}};
}

Json json(const FittedParameter& parameter) {
  return {{"value", parameter.value},
          {"unit", parameter.unit},
          {"interval_95", {parameter.least(), parameter.greatest()}},
          {"supported", parameter.supported}};
}

// What was used of the flight: the whole record of velocities, with the stretches shaded.
ReportSection selectionOf(const MotionCalibration& calibration) {
  Panel panel = timePanel("", "velocity [m/s]");
  const MotionTrace& trace = calibration.fit.traces.front();
  for (const TimeWindow& window : trace.stretches) panel.bands.push_back({window.from, window.to});
  for (const auto& [name, velocity] : calibration.record)
    panel.series.push_back(curveOf(velocity, name, kAxisColors[panel.series.size() % 3]));
  return selectionSection(
      "What was used",
      "All velocities that the log holds in flight; shaded: the stretches that the numbers come from.", panel,
      trace.time.front());
}

ReportSection timeFigure(const MotionTrace& trace, const DisturbanceBound* bound) {
  Comparison comparison = {
      trace.name, trace.unit, {trace.time, trace.measured}, {{"modelled", trace.modelled}}, {}};
  std::string caption = "On the data that the model was made from; below, what it leaves.";
  if (bound != nullptr) {
    comparison.bounds = {{bound->least, "bound"}, {bound->greatest, "bound"}};
    caption =
        "Above, what was measured and what thrust, attitude, gravity and drag explain; below, what is left, "
        "which is "
        "the disturbance, with its bounds.";
  }
  return comparisonSection(trace.name + ": measured and modelled", caption, comparison, trace.time.front());
}

// The objects of a map as a list, each with its key as `name`.
Json listed(const Json& map) {
  Json rows = Json::array();
  for (const auto& [name, object] : map.items()) {
    rows.push_back(object);
    rows.back()["name"] = name;
  }
  return rows;
}

void addTables(const Json& json, std::vector<ReportSection>* sections) {
  if (json.contains("disturbances")) {
    Json rows = listed(json["axes"]);
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i]["range"] = json["disturbances"][i]["range"];
    sections->push_back({"disturbance: bounds",
                         {wordsOn(json["share"]) + " of the time within, asked for with a confidence of " +
                          wordsOn(json["confidence"]) + "; all in m/s²."},
                         {},
                         tableOf(rows, {{"axis", "/name"},
                                        {"bound", "/range"},
                                        {"confidence reached", "/confidence"},
                                        {"independent samples", "/independent_samples"},
                                        {"mean", "/mean"},
                                        {"deviation", "/deviation"},
                                        {"supported", "/supported", Fault::kTrue}}),
                         {}});
  }
  if (json.contains("parameters"))
    sections->push_back({wordsOn(json["kind"]) + ": parameters",
                         {},
                         {},
                         tableOf(listed(json["parameters"]), {{"parameter", "/name"},
                                                              {"value", "/value"},
                                                              {"unit", "/unit"},
                                                              {"95 % interval", "/interval_95"},
                                                              {"supported", "/supported", Fault::kTrue}}),
                         {}});
  if (!json.contains("flights")) return;
  std::vector<ReportColumn> columns;
  for (const auto& [name, value] : json["flights"].front().items()) columns.push_back({name, "/" + name});
  sections->push_back({"What each flight says",
                       {"The numbers above are the means of these flights."},
                       {},
                       tableOf(json["flights"], columns),
                       {}});
}

}  // namespace

Json jsonOf(const MotionCalibration& calibration) {
  Json out = calibrationHead(calibration.kind, calibration, jsonOf(calibration.data));
  Json windows = Json::array();
  for (const std::vector<TimeWindow>& flight : calibration.windows) windows.push_back(jsonOf(flight));
  out["windows"] = windows.size() == 1 ? windows.front() : windows;
  if (!calibration.bounds.empty()) {
    out["share"] = calibration.limits.share;
    out["confidence"] = calibration.limits.confidence;
    for (const DisturbanceBound& bound : calibration.bounds) {
      out["disturbances"].push_back(
          {{"name", "d_" + bound.axis}, {"unit", "m/s^2"}, {"range", {bound.least, bound.greatest}}});
      out["axes"][bound.axis] = json(bound);
    }
  }
  for (const FittedParameter& parameter : calibration.fit.parameters)
    out["parameters"][parameter.name] = json(parameter);
  for (std::size_t i = 0; i < calibration.fit.flights.size(); ++i) {
    Json flight = {{"file", calibration.data[i].file}};
    for (const FittedParameter& parameter : calibration.fit.flights[i])
      flight[parameter.name] = parameter.value;
    out["flights"].push_back(flight);
  }
  out["warnings"] = calibration.fit.warnings;
  return out;
}

std::string toText(const MotionCalibration& calibration) {
  std::ostringstream out;
  out << notesOn(calibration);
  for (const DisturbanceBound& bound : calibration.bounds) {
    out << sentence(
        "d_%s  %.3f .. %.3f m/s^2 for %.4g %% of the time (confidence %.2f)   mean %.3f, deviation %.3f\n",
        bound.axis.c_str(), bound.least, bound.greatest, 100.0 * calibration.limits.share, bound.confidence,
        bound.mean, bound.deviation);
    for (const std::string& sentence : bound.warnings) out << "  warning: " << sentence << "\n";
  }
  for (const FittedParameter& parameter : calibration.fit.parameters) {
    out << sentence("%-16s %.5g ", parameter.name.c_str(), parameter.value)
        << (std::abs(parameter.half_width) < kNoInterval ? sentence("+- %.2g", parameter.half_width)
                                                         : "(no interval: the data do not bound it)")
        << (parameter.unit == "1" ? " " : " " + parameter.unit) << "\n";
  }
  for (const std::string& sentence : calibration.fit.warnings) out << "warning: " << sentence << "\n";
  return out.str();
}

Report reportOn(const MotionCalibration& calibration) {
  std::vector<std::string> reasons = calibration.fit.warnings;
  for (const DisturbanceBound& bound : calibration.bounds) {
    for (const std::string& warning : bound.warnings) reasons.push_back("d_" + bound.axis + ": " + warning);
  }
  Report page = calibrationPage(calibration, reasons);
  addTables(jsonOf(calibration), &page.sections);
  if (calibration.fit.traces.empty()) return page;
  if (!calibration.record.empty()) page.sections.push_back(selectionOf(calibration));
  for (std::size_t i = 0; i < calibration.fit.traces.size(); ++i) {
    const std::size_t axes = calibration.bounds.size();
    const DisturbanceBound* bound = axes > 0 ? &calibration.bounds[i % axes] : nullptr;
    page.sections.push_back(timeFigure(calibration.fit.traces[i], bound));
  }
  return page;
}

}  // namespace polyfly
