#include <ostream>

#include "report_page.hpp"
#include "report_parts.hpp"

namespace polyfly {
namespace {

void writeFact(const char* name, const std::string& value, std::ostream& out) {
  if (!value.empty()) out << "<tr><td>" << name << "</td><td>" << escaped(value) << "</td></tr>\n";
}

std::string mapText(const ParametersTold::Axis& axis) {
  std::string text;
  if (!axis.map.empty()) text = "map " + axis.map + " (" + axis.map_checksum + "), ";
  text += "problem " + (axis.problem.empty() ? "made of the options" : axis.problem);
  return text + (axis.calibration.empty() ? ", not calibrated" : ", calibrated: " + axis.calibration);
}

void writeChanges(const ParametersTold& parameters, std::ostream& out) {
  if (parameters.changes.empty()) {
    out << "<p>Nothing changed after the first command.</p>\n";
    return;
  }
  out << "<table class='facts'><tr><th>changed at</th><th>by</th><th>what</th></tr>\n";
  for (const ParametersTold::Change& change : parameters.changes) {
    std::string text;
    for (const std::string& one : change.parameters) text += (text.empty() ? "" : ", ") + one;
    out << "<tr" << (change.bears_on_replay ? " class='bad'" : "") << "><td>" << number(change.time, 4)
        << " s</td><td>" << escaped(change.cause) << "</td><td>" << escaped(text) << "</td></tr>\n";
  }
  out << "</table>\n";
}

}  // namespace

void writeParameters(const ValidationReport& report, std::ostream& out) {
  out << "<section><h2>Parameters in force</h2>";
  if (!report.parameters) {
    out << "<p>The bag does not tell them: record the topic parameters_in_force of the "
           "controller.</p></section>\n";
    return;
  }
  const ParametersTold& parameters = *report.parameters;
  out << "<p>What the controller told when the first command was sent. parameters_in_force.yaml beside this "
         "page holds "
         "all of them; rosparam load reads it, to fly the same again.</p><table class='facts'>\n";
  writeFact("node", parameters.node, out);
  writeFact("law", parameters.law, out);
  writeFact("calibrated options",
            parameters.provenance.empty() ? "none: no provenance is stated" : parameters.provenance, out);
  const bool has_problems = parameters.law != "nonlinear";
  for (std::size_t axis = 0; axis < parameters.axes.size() && has_problems; ++axis)
    writeFact(report.axes.at(axis).axis.c_str(), mapText(parameters.axes.at(axis)), out);
  out << "</table>\n";
  writeChanges(parameters, out);
  out << "</section>\n";
}

}  // namespace polyfly
