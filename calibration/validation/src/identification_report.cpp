#include "validation/identification_report.hpp"

#include <sstream>

#include "identification/flight_phases.hpp"
#include "report_page.hpp"

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
    out << "<tr><td>" << (i == 0 ? name : "") << "</td><td>"
        << (i == 0 ? number(fit.fit_percent, 4) + " %" : "") << "</td><td>" << escaped(parameter.name)
        << "</td><td>" << number(parameter.value, 4) << " "
        << escaped(parameter.unit == "1" ? "" : parameter.unit) << "</td><td>"
        << number(parameter.standard_error, 2) << "</td><td>" << number(parameter.least(), 4) << " .. "
        << number(parameter.greatest(), 4) << "</td></tr>\n";
  }
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
  out << "<section><h2>" << escaped(axis.axis) << ": parameters</h2><p>" << axis.with_delay.samples
      << " samples in " << axis.segments.size() << (axis.segments.size() == 1 ? " stretch" : " stretches");
  if (axis.validation) {
    out << "; on " << (axis.validation->by_halves ? "the second half" : "the other flight") << " the model "
        << (axis.validation->by_halves ? "of the first half " : "") << "reaches "
        << number(axis.validation->validation_percent, 4) << " %, on its own data "
        << number(axis.validation->training_percent, 4) << " %";
  }
  out << ".</p>";
  const std::vector<std::string> clauses = clausesOn(axis.choice.rejected);
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
  out << "</table></div></section>\n";
}

}  // namespace

std::string toHtml(const AttitudeCalibration& calibration) {
  std::ostringstream out;
  writeCalibrationHead(calibration.training, sentencesOf(calibration), out);
  for (const AxisModel& axis : calibration.axes) {
    writeTable(axis, out);
    for (const ReportFigure& figure : identificationFigures(axis)) writeFigureSection(figure, out);
  }
  out << kPageEnd;
  return out.str();
}

void writeReport(const AttitudeCalibration& calibration, const std::string& folder) {
  writePage(folder, toHtml(calibration), "calibration.yaml", toYaml(calibration));
}

}  // namespace polyfly
