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
  }
  return sentences;
}

void writeFit(const char* name, const LoopFit& fit, std::ostream& out) {
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

// What to do with the table.
void writeAdvice(const AxisModel& axis, std::ostream& out) {
  if (!axis.supported) {
    out << "<p><b>Not to be used:</b> these data do not support the numbers; the sentences on top say why, "
           "and "
           "calibrate apply refuses them.</p>";
    return;
  }
  if (axis.axis != "roll" && axis.axis != "pitch") return;
  const LoopFit& fit = axis.with_delay;
  const double tau = fit.find("tau")->value, delay = fit.find("delay")->value;
  out << "<p>For problem files: gain " << number(fit.find("gain")->value) << ", tau " << number(tau + delay)
      << " s (lag and delay together, what calibrate apply writes); a controller that compensates the delay "
         "takes "
         "tau "
      << number(tau) << " s and delay " << number(delay)
      << " s. The offset is a trim and goes into no model.</p>";
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
  out << "<div "
         "class='scroll'><table><tr><th>model</th><th>fit</th><th>parameter</th><th>value</th><th>standard "
         "error</th><th>95 % interval</th></tr>\n";
  writeFit("lag and delay", axis.with_delay, out);
  writeFit("lag alone", axis.without_delay, out);
  if (axis.second_order) writeFit("second order and delay", *axis.second_order, out);
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
