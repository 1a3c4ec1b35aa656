#include "validation/motion_report.hpp"

#include <cmath>
#include <sstream>

#include "report_page.hpp"
#include "report_parts.hpp"

namespace polyfly {
namespace {

std::vector<std::string> sentencesOf(const MotionCalibration& calibration) {
  std::vector<std::string> sentences = calibration.remarks;
  sentences.insert(sentences.end(), calibration.fit.warnings.begin(), calibration.fit.warnings.end());
  for (const DisturbanceBound& bound : calibration.bounds) {
    for (const std::string& warning : bound.warnings) sentences.push_back("d_" + bound.axis + ": " + warning);
  }
  return sentences;
}

void writeParameters(const MotionCalibration& calibration, std::ostream& out) {
  out << "<section><h2>" << escaped(calibration.kind)
      << ": parameters</h2><div class='scroll'><table><tr><th>parameter</th><th>value</th><th>95 % "
         "interval</th><th>supported</th></tr>\n";
  for (const FittedParameter& parameter : calibration.fit.parameters) {
    out << (parameter.supported && isBounded(parameter) ? "<tr><td>" : "<tr class='bad'><td>")
        << escaped(parameter.name) << "</td><td>" << number(parameter.value, 4) << " "
        << escaped(parameter.unit == "1" ? "" : parameter.unit) << "</td><td>" << intervalText(parameter)
        << "</td><td>" << (parameter.supported ? "yes" : "no") << "</td></tr>\n";
  }
  out << "</table></div>";
  std::vector<FlightNumbers> flights;
  for (std::size_t i = 0; i < calibration.fit.flights.size(); ++i)
    flights.push_back({calibration.data[i].file, calibration.fit.flights[i]});
  writeFlights(flights, out);
  out << "</section>\n";
}

void writeBounds(const MotionCalibration& calibration, std::ostream& out) {
  out << "<section><h2>disturbance: bounds</h2><p>" << number(100.0 * calibration.limits.share, 4)
      << " % of the time within, asked for with a confidence of " << number(calibration.limits.confidence)
      << "; all in m/s².</p><div "
         "class='scroll'><table><tr><th>axis</th><th>bound</th><th>confidence "
         "reached</th><th>independent samples</th><th>mean</th><th>deviation</th><th>supported</th></tr>\n";
  for (const DisturbanceBound& bound : calibration.bounds) {
    out << (bound.supported ? "<tr>" : "<tr class='bad'>") << "<td>" << escaped(bound.axis) << "</td><td>"
        << number(bound.least) << " .. " << number(bound.greatest) << "</td><td>" << number(bound.confidence)
        << "</td><td>" << number(bound.independent_samples, 4) << "</td><td>" << number(bound.mean)
        << "</td><td>" << number(bound.deviation) << "</td><td>" << (bound.supported ? "yes" : "no")
        << "</td></tr>\n";
  }
  out << "</table></div>";
  out << "</section>\n";
}

}  // namespace

std::string toHtml(const MotionCalibration& calibration) {
  std::ostringstream out;
  writeCalibrationHead(calibration.data, sentencesOf(calibration), out);
  if (!calibration.bounds.empty()) writeBounds(calibration, out);
  if (!calibration.fit.parameters.empty()) writeParameters(calibration, out);
  for (const ReportFigure& figure : motionFigures(calibration)) writeFigureSection(figure, out);
  out << kPageEnd;
  return out.str();
}

void writeReport(const MotionCalibration& calibration, const std::string& folder) {
  writePage(folder, toHtml(calibration), "calibration.yaml", toYaml(calibration));
}

}  // namespace polyfly
