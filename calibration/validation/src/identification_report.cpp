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

std::string fileOf(const AxisModel& flight) {
  return std::filesystem::path(flight.source).filename().string();
}

// What controllers can be given, each with its own evaluation.
void writeControllerModels(const AxisModel& axis, std::ostream& out) {
  out << "<div class='scroll'><table><tr><th>model for a controller</th><th>supported</th><th>fit</th>"
         "<th>validation</th><th>numbers</th><th>why not</th></tr>\n";
  for (const ControllerModel& model : axis.controller_models) {
    out << (model.supported() ? "<tr>" : "<tr class='bad'>") << "<td>" << escaped(model.title) << "<br><code>"
        << escaped(model.key) << "</code></td><td>" << (model.supported() ? "yes" : "<b>no</b>")
        << "</td><td>" << number(model.fit.fit_percent, 4) << " %</td><td>"
        << (model.validation ? number(model.validation->validation_percent, 4) + " %" : "none")
        << "</td><td>";
    for (const FittedParameter& one : model.fit.parameters)
      out << escaped(withUnit(one.name, one.unit)) << " " << valueWithin(one) << "<br>";
    out << "</td><td>";
    for (const std::string& sentence : model.reasons) out << escaped(sentence) << "<br>";
    out << "</td></tr>\n";
  }
  out << "</table></div>\n";
}

void writeTable(const AxisModel& axis, std::ostream& out) {
  out << "<section><h2>" << escaped(axis.axis) << ": parameters" << supportMark(axis.supported) << "</h2><p>"
      << escaped(answerOf(axis)) << "</p>";
  const std::vector<std::string> clauses = leftOutClauses(axis);
  if (!clauses.empty()) out << "<p>Left out:</p><ul>";
  for (const std::string& clause : clauses) out << "<li>" << escaped(clause) << "</li>";
  if (!clauses.empty()) out << "</ul>\n";
  writeControllerModels(axis, out);
  std::vector<FlightNumbers> flights;
  for (const AxisModel& flight : axis.flights)
    flights.push_back({fileOf(flight), flight.with_delay.parameters});
  writeFlights(flights, out);
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
