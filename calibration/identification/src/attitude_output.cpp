#include "identification/attitude_output.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <utility>

#include "identification/flight_phases.hpp"
#include "report/figures.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

constexpr double kGravity = 9.8066;  // [m/s^2]
constexpr const char* kRejectedColor = "#f6dcd3";

Json leftOut(const std::vector<RejectedWindow>& windows) {
  Json list = Json::array();
  for (const RejectedWindow& one : windows)
    list.push_back({{"from", one.window.from}, {"to", one.window.to}, {"reason", one.reason}});
  return list;
}

Json intervalOf(const FittedParameter& parameter) { return {parameter.least(), parameter.greatest()}; }

Json json(const ControllerModel& model) {
  Json out, intervals;
  for (const FittedParameter& one : model.fit.parameters) {
    out[one.name] = one.value;
    intervals[one.name] = intervalOf(one);
  }
  out["intervals_95"] = intervals;
  out["fit_percent"] = model.fit.fit_percent;
  if (model.validation) out["validation_percent"] = model.validation->validation_percent;
  out["supported"] = model.supported();
  out["reasons"] = model.reasons;
  return out;
}

Json flightJson(const AxisModel& flight) {
  Json parameters;
  for (const FittedParameter& one : flight.with_delay.parameters)
    parameters[one.name] = {{"value", one.value}, {"interval_95", intervalOf(one)}};
  return {{"file", fileName(flight.source)},
          {"windows", jsonOf(flight.choice.windows)},
          {"left_out", leftOut(flight.choice.rejected)},
          {"fit_percent", flight.with_delay.fit_percent},
          {"parameters", parameters}};
}

// The command that holds the vehicle, of a model of thrust.
double hoverCommand(const LoopFit& fit) { return (kGravity - fit.offset) / fit.gain; }

Json json(const AxisModel& axis) {
  Json out = {{"unit", axis.unit}, {"supported", axis.supported}};
  for (const ControllerModel& model : axis.controller_models) out[model.key] = json(model);
  if (axis.axis == "thrust") out["hover_command"] = hoverCommand(axis.with_delay);
  if (axis.flights.empty()) {
    out["windows"] = jsonOf(axis.choice.windows);
    out["left_out"] = leftOut(axis.choice.rejected);
  }
  for (const AxisModel& flight : axis.flights) out["flights"].push_back(flightJson(flight));
  out["samples"] = axis.with_delay.samples;
  if (axis.validation) {
    out["validation"] = {{"training_percent", axis.validation->training_percent},
                         {"validation_percent", axis.validation->validation_percent},
                         {"by_halves", axis.validation->by_halves},
                         {"by_flights", axis.validation->by_flights}};
  }
  out["warnings"] = axis.warnings;
  return out;
}

// Without a zero before the point.
std::string shortNumber(double value) {
  std::string number = sentence(std::abs(value) < 1.0 ? "%.3f" : "%.4g", value);
  const std::size_t zero = number.find("0.");
  if (zero == 0 || (zero == 1 && number[0] == '-')) number.erase(zero, 1);
  return number;
}

// The numbers of a model, and half of each interval.
struct NumbersText {
  std::string values;
  std::string half_widths;
};

NumbersText numbersOf(const LoopFit& fit) {
  NumbersText text;
  for (const FittedParameter& one : fit.parameters) {
    if (one.name == "offset") continue;
    const std::string unit = one.unit.empty() || one.unit == "1" ? "" : " " + one.unit;
    const std::string comma = text.values.empty() ? "" : ", ";
    text.values += comma + (one.name == "tau" ? "lag" : one.name) + " " + shortNumber(one.value) + unit;
    text.half_widths +=
        comma + (std::isfinite(one.half_width) ? shortNumber(one.half_width) + unit : "unknown");
  }
  return text;
}

const char* validatedOn(const AxisValidationFit& validation) {
  if (validation.by_flights) return "on each flight by the others";
  return validation.by_halves ? "on the second half" : "on the other flight";
}

// What was left out of the axis, a clause for each reason; of several flights with the file.
std::vector<std::string> leftOutClauses(const AxisModel& axis) {
  std::vector<std::string> clauses = clausesOn(axis.choice.rejected);
  for (const AxisModel& flight : axis.flights) {
    for (const std::string& clause : clausesOn(flight.choice.rejected))
      clauses.push_back(fileName(flight.source) + ": " + clause);
  }
  return clauses;
}

// First time of the record, from which figures of a record since 1970 count [s].
double startOf(const AxisModel& axis) {
  return std::min(axis.record.response.time.front(), axis.record.command.time.front());
}

ReportSection selectionFigure(const AxisModel& axis, const std::string& begin) {
  Panel panel = timePanel("", withUnit(axis.axis, axis.unit));
  for (const TimeWindow& window : axis.choice.windows) panel.bands.push_back({window.from, window.to});
  for (const RejectedWindow& rejected : axis.choice.rejected)
    panel.bands.push_back({rejected.window.from, rejected.window.to, kRejectedColor});
  panel.series = {curveOf(axis.record.response, "measured", kMeasuredColor)};
  if (axis.command_unit == axis.unit) {
    panel.series.push_back(curveOf(axis.record.command, "command", palette::kVermilion));
    panel.series.back().style = Series::Style::kSteps;
  }
  return selectionSection(
      begin + axis.axis + ": what was used",
      "The whole record; shaded yellow: used; shaded red: left out, for the reasons listed above.", panel,
      startOf(axis));
}

// The models on segments, those of the fit or of the validation.
Comparison comparisonOn(const AxisModel& axis, const std::vector<LoopSegment>& segments, bool validated) {
  Comparison result = {axis.axis, axis.unit, {}, {}, {}};
  const auto append = [](const std::vector<double>& part, std::vector<double>* all) {
    all->insert(all->end(), part.begin(), part.end());
  };
  for (const LoopSegment& segment : segments) {
    append(segment.time, &result.measured.time);
    append(segment.response, &result.measured.value);
  }
  for (const ControllerModel& one : axis.controller_models) {
    if (validated && !one.validation) continue;
    result.models.emplace_back(one.title, std::vector<double>());
    for (const std::vector<double>& part : validated ? one.validation->prediction : one.fit.prediction)
      append(part, &result.models.back().second);
  }
  return result;
}

void addFigures(const AxisModel& axis, const std::string& begin, std::vector<ReportSection>* sections) {
  sections->push_back(selectionFigure(axis, begin));
  sections->push_back(comparisonSection(begin + axis.axis + ": measured and modelled",
                                        "On the data that the models were made from; below, what they leave.",
                                        comparisonOn(axis, axis.segments, false), startOf(axis)));
  if (!axis.validation || axis.validation->segments.empty()) return;
  const std::vector<LoopSegment>& segments = axis.validation->segments;
  const std::string models = axis.validation->by_halves
                                 ? "The models of the first half of the data on the second half"
                                 : "The models on " + axis.validation->source;
  // Another flight has a clock of its own.
  const double first = axis.validation->by_halves ? startOf(axis) : segments.front().time.front();
  sections->push_back(comparisonSection(begin + axis.axis + ": validation",
                                        models + ", which they have not seen.",
                                        comparisonOn(axis, segments, true), first));
}

// What controllers can be given, each with its own evaluation, and what each flight says.
void addTables(const AxisModel& axis, std::vector<ReportSection>* sections) {
  Json rows = Json::array();
  for (const ControllerModel& model : axis.controller_models) {
    rows.push_back(json(model));
    rows.back()["model"] = model.title + " (" + model.key + ")";
    const NumbersText numbers = numbersOf(model.fit);
    rows.back()["numbers"] = numbers.values;
    rows.back()["half_widths"] = numbers.half_widths;
  }
  ReportSection section = {axis.axis + (axis.supported ? ": supported" : ": not supported"),
                           {answerOf(axis)}};
  for (const std::string& clause : leftOutClauses(axis)) section.sentences.push_back("Left out: " + clause);
  section.table = tableOf(rows, {{"model for a controller", "/model"},
                                 {"supported", "/supported", ReportColumn::Rule::kTrue},
                                 {"fit [%]", "/fit_percent"},
                                 {"validation [%]", "/validation_percent"},
                                 {"numbers", "/numbers"},
                                 {"±", "/half_widths"},
                                 {"why not", "/reasons"}});
  sections->push_back(section);
  if (axis.flights.empty()) return;
  sections->push_back({"What each flight says of " + axis.axis,
                       {"The numbers above are the means of these flights."},
                       {},
                       tableOf(json(axis)["flights"], {{"flight", "/file"},
                                                       {"gain", "/parameters/gain/value"},
                                                       {"its interval", "/parameters/gain/interval_95"},
                                                       {"lag [s]", "/parameters/tau/value"},
                                                       {"its interval", "/parameters/tau/interval_95"},
                                                       {"delay [s]", "/parameters/delay/value"},
                                                       {"its interval", "/parameters/delay/interval_95"},
                                                       {"fit [%]", "/fit_percent"}}),
                       {}});
}

}  // namespace

std::string answerOf(const AxisModel& axis) {
  const NumbersText numbers = numbersOf(axis.with_delay);
  std::string answer = axis.axis + ": " + numbers.values;
  if (axis.axis == "thrust") answer += ", hover command " + shortNumber(hoverCommand(axis.with_delay));
  answer += axis.supported ? ", supported" : ", NOT SUPPORTED";
  answer += sentence(" (%.0f of %.0f s)\n  +- ", axis.usedTime(), axis.movingTime()) + numbers.half_widths +
            sentence("; fit %.1f %%", axis.with_delay.fit_percent);
  if (!axis.validation) return answer;
  return answer + sentence(", %.1f %% ", axis.validation->validation_percent) + validatedOn(*axis.validation);
}

Json jsonOf(const AttitudeCalibration& calibration) {
  Json data = {{"training", jsonOf(calibration.data)}};
  if (calibration.validation) data["validation"] = jsonOf(std::vector<Provenance>{*calibration.validation});
  Json out = calibrationHead("attitude", calibration, data);
  out["axes"] = Json::object();
  for (const AxisModel& axis : calibration.axes) out["axes"][axis.axis] = json(axis);
  if (!calibration.failed.empty()) out["failed"] = calibration.failed;
  return out;
}

std::string toText(const AttitudeCalibration& calibration) {
  std::ostringstream out;
  out << notesOn(calibration);
  for (const AxisModel& axis : calibration.axes) {
    out << answerOf(axis) << "\n";
    for (const ControllerModel& model : axis.controller_models) {
      if (model.fit.shape.order == LoopOrder::kSecond)
        out << "  " << model.title << ": " << numbersOf(model.fit).values
            << (model.supported() ? ", supported\n" : ", NOT SUPPORTED\n");
      for (const std::string& sentence : model.reasons) out << "  " << model.key << ": " << sentence << "\n";
    }
    for (const std::string& clause : leftOutClauses(axis)) out << "  left out: " << clause << "\n";
    for (const std::string& sentence : axis.warnings) out << "  warning: " << sentence << "\n";
  }
  for (const std::string& sentence : calibration.failed) out << "not identified: " << sentence << "\n";
  return out.str();
}

Report reportOn(const AttitudeCalibration& calibration) {
  std::vector<std::string> reasons = calibration.failed;
  for (const AxisModel& axis : calibration.axes) {
    for (const std::string& warning : axis.warnings) reasons.push_back(axis.axis + ": " + warning);
    if (!axis.supported)
      reasons.push_back(axis.axis + ": The model that problem files take is not supported: do not use it.");
  }
  Report page = calibrationPage(calibration, reasons);
  for (const AxisModel& axis : calibration.axes) {
    addTables(axis, &page.sections);
    if (axis.flights.empty()) addFigures(axis, "", &page.sections);
    for (const AxisModel& flight : axis.flights)
      addFigures(flight, fileName(flight.source) + ": ", &page.sections);
  }
  return page;
}

}  // namespace polyfly
