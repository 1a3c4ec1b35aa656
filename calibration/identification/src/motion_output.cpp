#include "identification/motion_output.hpp"

#include <cstdio>
#include <sstream>

#include "identification/yaml_text.hpp"

namespace polyfly {
namespace {

void writeSentences(const char* key, const char* indent, const std::vector<std::string>& sentences,
                    std::ostream& out) {
  out << indent << key << ":" << (sentences.empty() ? " []" : "") << "\n";
  for (const std::string& sentence : sentences) out << indent << "  - " << yamlString(sentence) << "\n";
}

void writeWindowList(const std::vector<TimeWindow>& windows, std::ostream& out) {
  out << "[";
  for (std::size_t i = 0; i < windows.size(); ++i) {
    out << (i > 0 ? ", " : "") << "[" << yamlNumber(windows[i].from) << ", " << yamlNumber(windows[i].to)
        << "]";
  }
  out << "]";
}

void writeBounds(const MotionCalibration& calibration, std::ostream& out) {
  out << "share: " << yamlNumber(calibration.limits.share)
      << "  # of the time within the bounds\nconfidence: " << yamlNumber(calibration.limits.confidence)
      << "  # asked for\ndisturbances:  # as problem and model files take them\n";
  for (const DisturbanceBound& bound : calibration.bounds) {
    out << "  - {name: d_" << bound.axis << ", unit: m/s^2, range: [" << yamlNumber(bound.least) << ", "
        << yamlNumber(bound.greatest) << "]}\n";
  }
  out << "axes:\n";
  for (const DisturbanceBound& bound : calibration.bounds) {
    out << "  " << bound.axis << ":\n    mean: " << yamlNumber(bound.mean)
        << "\n    deviation: " << yamlNumber(bound.deviation)
        << "\n    supported: " << (bound.supported ? "true" : "false")
        << "\n    confidence: " << yamlNumber(bound.confidence)
        << "  # reached\n    independent_samples: " << yamlNumber(bound.independent_samples)
        << "\n    quantiles: [";
    for (std::size_t i = 0; i < bound.quantiles.size(); ++i) {
      out << (i > 0 ? ", " : "") << "[" << yamlNumber(bound.quantiles[i].first) << ", "
          << yamlNumber(bound.quantiles[i].second) << "]";
    }
    out << "]\n";
    writeSentences("warnings", "    ", bound.warnings, out);
  }
}

}  // namespace

std::string toYaml(const MotionCalibration& calibration) {
  std::ostringstream out;
  out << "polyfly_calibration: 1\nkind: " << calibration.kind
      << "\ntool_version: " << yamlString(kIdentificationVersion) << "\ndata:";
  const bool several = calibration.data.size() > 1;
  for (const Provenance& flight : calibration.data)
    out << (several ? "\n  - " : " ") << provenanceMap(flight);
  out << "\n" << vehicleLine(calibration.vehicle) << "windows:";
  for (const std::vector<TimeWindow>& windows : calibration.windows) {
    out << (several ? "\n  - " : " ");
    writeWindowList(windows, out);
    out << "  # [s] in the file's own time; empty: all of it";
  }
  out << "\ninterval_holds_for: " << (several ? "the vehicle, between flights" : "this flight alone") << "\n";
  writeSentences("remarks", "", calibration.remarks, out);
  if (!calibration.bounds.empty()) writeBounds(calibration, out);
  if (!calibration.parameters.empty()) out << "parameters:\n";
  for (const FittedParameter& parameter : calibration.parameters) {
    out << "  " << parameter.name << ": {value: " << yamlNumber(parameter.value)
        << ", unit: " << yamlString(parameter.unit)
        << ", standard_error: " << yamlNumber(parameter.standard_error) << ", interval_95: ["
        << yamlNumber(parameter.least()) << ", " << yamlNumber(parameter.greatest())
        << "], supported: " << (parameter.supported ? "true" : "false");
    if (several) out << ", between_flights: " << yamlNumber(parameter.between_flights);
    out << "}\n";
  }
  if (!calibration.flights.empty()) out << "flights:  # values of each flight\n";
  for (std::size_t i = 0; i < calibration.flights.size(); ++i) {
    out << "  - {file: " << yamlString(calibration.data[i].file);
    for (const FittedParameter& parameter : calibration.flights[i])
      out << ", " << parameter.name << ": " << yamlNumber(parameter.value);
    out << "}\n";
  }
  writeSentences("warnings", "", calibration.warnings, out);
  return out.str();
}

std::string toText(const MotionCalibration& calibration) {
  std::ostringstream out;
  char text[200];
  for (const std::string& sentence : calibration.remarks) out << "note: " << sentence << "\n";
  for (const DisturbanceBound& bound : calibration.bounds) {
    std::snprintf(
        text, sizeof text,
        "d_%s  %.3f .. %.3f m/s^2 for %.4g %% of the time (confidence %.2f)   mean %.3f, deviation %.3f\n",
        bound.axis.c_str(), bound.least, bound.greatest, 100.0 * calibration.limits.share, bound.confidence,
        bound.mean, bound.deviation);
    out << text;
    for (const std::string& sentence : bound.warnings) out << "  warning: " << sentence << "\n";
  }
  for (const FittedParameter& parameter : calibration.parameters) {
    std::snprintf(text, sizeof text, "%-16s %s %s\n", parameter.name.c_str(),
                  valueText(parameter.value, parameter.half_width).c_str(),
                  parameter.unit == "1" ? "" : parameter.unit.c_str());
    out << text;
  }
  out << (calibration.data.size() > 1 ? "the numbers hold the spread between "
                                      : "the numbers hold for this flight alone");
  if (calibration.data.size() > 1) out << calibration.data.size() << " flights";
  out << "\n";
  for (const std::string& sentence : calibration.warnings) out << "warning: " << sentence << "\n";
  return out.str();
}

}  // namespace polyfly
