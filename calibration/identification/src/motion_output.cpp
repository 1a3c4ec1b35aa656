#include "identification/motion_output.hpp"

#include <sstream>

#include "identification/yaml_text.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

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
        << "  # reached\n    independent_samples: " << yamlNumber(bound.independent_samples) << "\n";
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
    out << windowList(windows);
    out << "  # [s] in the file's own time; empty: all of it";
  }
  out << "\n";
  writeSentences("remarks", "", calibration.remarks, out);
  if (!calibration.bounds.empty()) writeBounds(calibration, out);
  if (!calibration.fit.parameters.empty()) out << "parameters:\n";
  for (const FittedParameter& parameter : calibration.fit.parameters) {
    out << "  " << parameter.name << ": {value: " << yamlNumber(parameter.value)
        << ", unit: " << yamlString(parameter.unit)
        << ", standard_error: " << yamlNumber(parameter.standard_error) << ", interval_95: ["
        << yamlNumber(parameter.least()) << ", " << yamlNumber(parameter.greatest())
        << "], supported: " << (parameter.supported ? "true" : "false") << "}\n";
  }
  if (!calibration.fit.flights.empty()) out << "flights:  # values of each flight\n";
  for (std::size_t i = 0; i < calibration.fit.flights.size(); ++i) {
    out << "  - {file: " << yamlString(calibration.data[i].file);
    for (const FittedParameter& parameter : calibration.fit.flights[i])
      out << ", " << parameter.name << ": " << yamlNumber(parameter.value);
    out << "}\n";
  }
  writeSentences("warnings", "", calibration.fit.warnings, out);
  return out.str();
}

std::string toText(const MotionCalibration& calibration) {
  std::ostringstream out;
  for (const std::string& sentence : calibration.remarks) out << "note: " << sentence << "\n";
  for (const DisturbanceBound& bound : calibration.bounds) {
    out << sentence(
        "d_%s  %.3f .. %.3f m/s^2 for %.4g %% of the time (confidence %.2f)   mean %.3f, deviation %.3f\n",
        bound.axis.c_str(), bound.least, bound.greatest, 100.0 * calibration.limits.share, bound.confidence,
        bound.mean, bound.deviation);
    for (const std::string& sentence : bound.warnings) out << "  warning: " << sentence << "\n";
  }
  for (const FittedParameter& parameter : calibration.fit.parameters) {
    out << sentence("%-16s %s %s\n", parameter.name.c_str(),
                    valueText(parameter.value, parameter.half_width).c_str(),
                    parameter.unit == "1" ? "" : parameter.unit.c_str());
  }
  for (const std::string& sentence : calibration.fit.warnings) out << "warning: " << sentence << "\n";
  return out.str();
}

}  // namespace polyfly
