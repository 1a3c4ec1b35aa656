#include "validation/identification_report.hpp"

#include <filesystem>
#include <sstream>

#include "report_page.hpp"
#include "report_parts.hpp"

namespace polyfly {
namespace {

std::vector<std::string> sentencesOf(const AttitudeCalibration& calibration) {
  std::vector<std::string> sentences = calibration.remarks;
  sentences.insert(sentences.end(), calibration.failed.begin(), calibration.failed.end());
  for (const AxisModel& axis : calibration.axes) {
    for (const std::string& warning : axis.warnings) sentences.push_back(axis.axis + ": " + warning);
    if (!axis.supported)
      sentences.push_back(axis.axis + ": The model that problem files take is not supported: do not use it.");
  }
  return sentences;
}

void writeFit(const std::string& name, const LoopFit& fit, std::ostream& out) {
  for (std::size_t i = 0; i < fit.parameters.size(); ++i) {
    const FittedParameter& parameter = fit.parameters[i];
    out << (isBounded(parameter) ? "<tr><td>" : "<tr class='bad'><td>") << (i == 0 ? name : "") << "</td><td>"
        << (i == 0 ? number(fit.fit_percent, 4) + " %" : "") << "</td><td>" << escaped(parameter.name)
        << "</td><td>" << number(parameter.value, 4) << " "
        << escaped(parameter.unit == "1" ? "" : parameter.unit) << "</td><td>"
        << number(parameter.standard_error, 2) << "</td><td>" << intervalText(parameter) << "</td></tr>\n";
  }
}

std::string fileOf(const AxisModel& flight) {
  return std::filesystem::path(flight.source).filename().string();
}

// What each of several flights says.
void writeFlights(const AxisModel& axis, std::ostream& out) {
  if (axis.flights.empty()) return;
  out << "<h3>What each flight says</h3><p>The numbers above are the means of " << axis.flights.size()
      << " flights.</p><div class='scroll'><table class='numbers'><tr><th>flight</th><th>fit</th>";
  for (const FittedParameter& parameter : axis.with_delay.parameters)
    out << "<th>" << escaped(withUnit(parameter.name, parameter.unit)) << "</th>";
  out << "</tr>\n";
  for (const AxisModel& flight : axis.flights) {
    out << "<tr><td>" << escaped(fileOf(flight)) << "</td><td>"
        << number(flight.with_delay.fit_percent, 3) << " %</td>";
    for (const FittedParameter& parameter : flight.with_delay.parameters)
      out << "<td>" << valueWithin(parameter) << "</td>";
    out << "</tr>\n";
  }
  out << "</table></div>\n";
}

// What controllers can be given, each with its own evaluation.
void writeControllerModels(const AxisModel& axis, std::ostream& out) {
  out << "<div class='scroll'><table><tr><th>model for a controller</th><th>supported</th><th>fit</th>"
         "<th>validation</th><th>why not</th></tr>\n";
  for (const ControllerModel& model : axis.controller_models) {
    out << (model.supported() ? "<tr>" : "<tr class='bad'>") << "<td>" << escaped(model.title) << "<br><code>"
        << escaped(model.key) << "</code></td><td>" << (model.supported() ? "yes" : "<b>no</b>")
        << "</td><td>" << number(model.fit.fit_percent, 4) << " %</td><td>"
        << (model.validation ? number(model.validation->validation_percent, 4) + " %" : "none")
        << "</td><td>";
    for (const std::string& sentence : model.reasons) out << escaped(sentence) << "<br>";
    out << "</td></tr>\n";
  }
  out << "</table></div>\n";
}

// What calibrate apply does with the axis.
void writeAdvice(const AxisModel& axis, std::ostream& out) {
  if (!axis.supported) {
    out << "<p><b>Not to be used:</b> the data do not support the model that problem files take; calibrate "
           "apply "
           "refuses it.</p>";
    return;
  }
  const ControllerModel* lag = axis.findModel("model_without_delay");
  if (lag == nullptr || (axis.axis != "roll" && axis.axis != "pitch")) return;
  out << "<p>calibrate apply writes gain " << number(lag->fit.gain) << " and tau "
      << number(lag->fit.shape.tau)
      << " s: lag and delay together. The offset is a trim and goes into no model.</p>";
}

void writeTable(const AxisModel& axis, std::ostream& out) {
  out << "<section><h2>" << escaped(axis.axis) << ": parameters" << supportMark(axis.supported) << "</h2><p>"
      << axis.with_delay.samples << " samples in " << number(axis.usedTime()) << " s of "
      << number(axis.movingTime()) << " s in which the command moves";
  if (axis.validation) {
    out << "; on "
        << (axis.validation->by_flights  ? "each flight"
            : axis.validation->by_halves ? "the second half"
                                         : "the other flight")
        << " the model "
        << (axis.validation->by_flights  ? "of the others "
            : axis.validation->by_halves ? "of the first half "
                                         : "")
        << "reaches " << number(axis.validation->validation_percent, 4) << " %, on its own data "
        << number(axis.validation->training_percent, 4) << " %";
  }
  out << ".</p>";
  const std::vector<std::string> clauses = leftOutClauses(axis);
  if (!clauses.empty()) out << "<p>Left out:</p><ul>";
  for (const std::string& clause : clauses) out << "<li>" << escaped(clause) << "</li>";
  if (!clauses.empty()) out << "</ul>\n";
  writeAdvice(axis, out);
  writeControllerModels(axis, out);
  out << "<div "
         "class='scroll'><table><tr><th>model</th><th>fit</th><th>parameter</th><th>value</th><th>standard "
         "error</th><th>95 % interval</th></tr>\n";
  writeFit("lag alone", axis.without_delay, out);
  for (const ControllerModel& model : axis.controller_models) writeFit(model.title, model.fit, out);
  out << "</table></div>\n";
  writeFlights(axis, out);
  out << "</section>\n";
}

void writeFigures(const AxisModel& flight, const std::string& begin, std::ostream& out) {
  for (ReportFigure& figure : identificationFigures(flight)) {
    figure.heading = begin + figure.heading;
    writeFigureSection(figure, out);
  }
}

}  // namespace

std::string toHtml(const AttitudeCalibration& calibration) {
  std::ostringstream out;
  writeCalibrationHead(calibration.training, sentencesOf(calibration), out);
  for (const AxisModel& axis : calibration.axes) {
    writeTable(axis, out);
    if (axis.flights.empty()) writeFigures(axis, "", out);
    for (const AxisModel& flight : axis.flights) writeFigures(flight, fileOf(flight) + ": ", out);
  }
  out << kPageEnd;
  return out.str();
}

void writeReport(const AttitudeCalibration& calibration, const std::string& folder) {
  writePage(folder, toHtml(calibration), "calibration.yaml", toYaml(calibration));
}

}  // namespace polyfly
