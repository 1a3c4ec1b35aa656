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

void writeNumbers(const std::vector<double>& numbers, std::ostream& out) {
  out << "[";
  for (std::size_t i = 0; i < numbers.size(); ++i) out << (i > 0 ? ", " : "") << yamlNumber(numbers[i]);
  out << "]";
}

void writeCurve(const IdentifiedCurve& curve, std::ostream& out) {
  out << "curve:\n  polynomial: ";
  writeNumbers(curve.polynomial, out);
  out << "  # command = c[0] + c[1] F + c[2] F^2 + ..., F in N\n  supported: "
      << (curve.supported() ? "true" : "false") << "\n";
  writeSentences("reasons", "  ", curve.reasons, out);
  out << "  mass: " << yamlNumber(curve.mass) << "  # [kg]\n  thrusts: ";
  writeNumbers(curve.thrusts, out);
  out << "  # [N] of command_1 ..; the first and the last are the ends of what was flown\n";
  if (curve.voltage.logged) {
    out << "  voltage: " << yamlNumber(curve.voltage.mean)
        << "  # [V] that the curve is for\n  voltage_range: ";
    writeNumbers({curve.voltage.least, curve.voltage.greatest}, out);
    out << "  # [V] that was flown\n  voltage_matters: " << (curve.voltage.matters ? "true" : "false")
        << "\n";
  }
  out << "  lag: " << yamlNumber(curve.lag) << "  # [s]\n  delay: " << yamlNumber(curve.delay)
      << "  # [s]\n  fit_percent: " << yamlNumber(curve.fit_percent)
      << "\n  validation_percent: " << yamlNumber(curve.validation_percent) << "\n";
}

std::string curveText(const IdentifiedCurve& curve) {
  std::ostringstream out;
  char text[200];
  out << "command =";
  for (std::size_t i = 0; i < curve.polynomial.size(); ++i) {
    std::snprintf(text, sizeof text,
                  i == 0   ? " %.6g"
                  : i == 1 ? " %+.6g F"
                           : " %+.6g F^%zu",
                  curve.polynomial[i], i);
    out << text;
  }
  out << "   F in N\n" << validityOf(curve) << "\n";
  std::snprintf(text, sizeof text, "fit %.1f %%, on other data %.1f %%   lag %.3f s, delay %.3f s   %s\n",
                curve.fit_percent, curve.validation_percent, curve.lag, curve.delay,
                curve.supported() ? "supported" : "not supported");
  out << text;
  return out.str();
}

}  // namespace

std::string validityOf(const IdentifiedCurve& curve) {
  char text[200];
  std::snprintf(text, sizeof text, "%.3g to %.3g N", curve.thrusts.front(), curve.thrusts.back());
  std::string validity = std::string("The curve holds from ") + text;
  if (!curve.voltage.logged) return validity + ", at a voltage that is not known.";
  std::snprintf(text, sizeof text, ", at %.1f to %.1f V.", curve.voltage.least, curve.voltage.greatest);
  return validity + text;
}

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
  if (calibration.curve) writeCurve(*calibration.curve, out);
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
  if (calibration.curve) out << curveText(*calibration.curve);
  out << (calibration.data.size() > 1 ? "the numbers hold the spread between "
                                      : "the numbers hold for this flight alone");
  if (calibration.data.size() > 1) out << calibration.data.size() << " flights";
  out << "\n";
  for (const std::string& sentence : calibration.warnings) out << "warning: " << sentence << "\n";
  return out.str();
}

}  // namespace polyfly
