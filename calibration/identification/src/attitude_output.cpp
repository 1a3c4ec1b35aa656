#include "identification/attitude_output.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "identification/yaml_text.hpp"

namespace polyfly {
namespace {

constexpr double kGravity = 9.8066;  // [m/s^2]

void writeWindows(const std::vector<TimeWindow>& windows, std::ostream& out) {
  out << "[";
  for (std::size_t i = 0; i < windows.size(); ++i) {
    out << (i > 0 ? ", " : "") << "[" << yamlNumber(windows[i].from) << ", " << yamlNumber(windows[i].to)
        << "]";
  }
  out << "]";
}

// One flight as a map, several as a list.
void writeProvenance(const char* key, const std::vector<Provenance>& flights, std::ostream& out) {
  out << "  " << key << ":";
  for (const Provenance& flight : flights)
    out << (flights.size() > 1 ? "\n    - " : " ") << provenanceMap(flight);
  out << "\n";
}

// What each of several flights gave, and the model of the others on it.
void writeFlights(const AxisModel& axis, std::ostream& out) {
  out << "    interval_holds_for: "
      << (axis.flights.empty() ? "this flight alone" : "the vehicle, between flights") << "\n";
  if (axis.flights.empty()) return;
  out << "    flights:\n";
  for (const AxisFlight& flight : axis.flights) {
    out << "      - file: " << yamlString(std::filesystem::path(flight.source).filename().string())
        << "\n        windows: ";
    writeWindows(flight.windows, out);
    out << "\n        fit_percent: " << yamlNumber(flight.fit_percent)
        << "\n        left_out_percent: " << yamlNumber(flight.left_out_percent)
        << "  # of the other flights' model\n        parameters:\n";
    for (const FittedParameter& parameter : flight.parameters) {
      out << "          " << parameter.name << ": {value: " << yamlNumber(parameter.value)
          << ", interval_95: [" << yamlNumber(parameter.least()) << ", " << yamlNumber(parameter.greatest())
          << "]}\n";
    }
  }
}

void writeFit(const char* key, const AxisModel& axis, const LoopFit& fit, std::ostream& out) {
  out << "    " << key << ":\n      fit_percent: " << yamlNumber(fit.fit_percent)
      << "\n      residual_rms: " << yamlNumber(fit.residual_rms) << "\n      parameters:\n";
  for (const FittedParameter& parameter : fit.parameters) {
    out << "        " << parameter.name << ": {value: " << yamlNumber(parameter.value)
        << ", standard_error: " << yamlNumber(parameter.standard_error) << ", interval_95: ["
        << yamlNumber(parameter.least()) << ", " << yamlNumber(parameter.greatest()) << "]";
    if (!axis.flights.empty()) out << ", between_flights: " << yamlNumber(parameter.between_flights);
    out << "}\n";
  }
  out << "      correlation:  # of the parameters in their order\n";
  for (Eigen::Index row = 0; row < fit.correlation.rows(); ++row) {
    out << "        - [";
    for (Eigen::Index column = 0; column < fit.correlation.cols(); ++column) {
      out << (column > 0 ? ", " : "") << yamlNumber(fit.correlation(row, column));
    }
    out << "]\n";
  }
}

// What a controller takes: the lag of Eq. 37 as it stands cannot hold a delay.
void writeModel(const AxisModel& axis, std::ostream& out) {
  const LoopFit& fit = axis.with_delay;
  if (axis.axis == "thrust") {
    out << "    model: {gain: " << yamlNumber(fit.gain) << ", tau: " << yamlNumber(fit.shape.tau)
        << ", delay: " << yamlNumber(fit.shape.delay) << ", offset: " << yamlNumber(fit.offset)
        << "}  # m/s^2 per command\n    hover_command: " << yamlNumber((kGravity - fit.offset) / fit.gain)
        << "  # where the model holds 9.8066 m/s^2\n";
    return;
  }
  out << "    model: {gain: " << yamlNumber(fit.gain) << ", tau: " << yamlNumber(fit.shape.tau)
      << ", delay: " << yamlNumber(fit.shape.delay)
      << "}  # Eq. 37 with delay, for a controller that compensates it\n"
      << "    model_without_delay: {gain: " << yamlNumber(fit.gain)
      << ", tau: " << yamlNumber(fit.shape.tau + fit.shape.delay)
      << "}  # for one that does not: the delay counted as lag\n";
  if (axis.second_order) {
    const LoopFit& second = *axis.second_order;
    out << "    model_second_order: {a0: " << yamlNumber(second.find("a0")->value)
        << ", a1: " << yamlNumber(second.find("a1")->value)
        << ", b0: " << yamlNumber(second.find("b0")->value) << ", delay: " << yamlNumber(second.shape.delay)
        << "}  # Eq. 45\n";
  }
}

void writeAxis(const AxisModel& axis, std::ostream& out) {
  out << "  " << axis.axis << ":\n    unit: " << yamlString(axis.unit) << "\n";
  out << "    supported: " << (axis.supported ? "true" : "false")
      << "  # whether the data say enough for a controller\n";
  writeModel(axis, out);
  writeFlights(axis, out);
  if (axis.flights.empty()) {
    out << "    windows: ";
    writeWindows(axis.choice.windows, out);
    out << "  # [s] in the file's own time\n";
  }
  out << "    samples: " << axis.with_delay.samples << "\n";
  if (axis.validation) {
    out << "    validation: {training_percent: " << yamlNumber(axis.validation->training_percent)
        << ", validation_percent: " << yamlNumber(axis.validation->validation_percent)
        << ", by_halves: " << (axis.validation->by_halves ? "true" : "false")
        << ", by_flights: " << (axis.validation->by_flights ? "true" : "false") << "}\n";
  }
  writeFit("with_delay", axis, axis.with_delay, out);
  writeFit("without_delay", axis, axis.without_delay, out);
  if (axis.second_order) writeFit("second_order", axis, *axis.second_order, out);
  out << "    warnings:" << (axis.warnings.empty() ? " []" : "") << "\n";
  for (const std::string& sentence : axis.warnings) out << "      - " << yamlString(sentence) << "\n";
}

std::string row(const char* name, const LoopFit& fit) {
  char head[64];
  std::snprintf(head, sizeof head, "  %-22s fit %6.1f %%  ", name, fit.fit_percent);
  std::string line = head;
  for (const FittedParameter& parameter : fit.parameters) {
    line += "  " + parameter.name + " ";
    if (parameter.name == "delay" && std::isnan(parameter.half_width)) {
      // The search has ended at its least delay.
      line += "0 s (none is seen)";
      continue;
    }
    line += valueText(parameter.value, parameter.half_width);
    if (!parameter.unit.empty() && parameter.unit != "1") line += " " + parameter.unit;
  }
  return line + "\n";
}

// How far the intervals reach: between flights, or for the only flight.
void writeSpread(const AxisModel& axis, std::ostream& out) {
  if (axis.flights.empty()) {
    out << "  the intervals hold for this flight alone; several flights show what changes between them\n";
    return;
  }
  out << "  the intervals hold the spread between " << axis.flights.size() << " flights:\n";
  for (const AxisFlight& flight : axis.flights) {
    char fits[80];
    std::snprintf(fits, sizeof fits, "  fit %.1f %%, by the model of the others %.1f %%\n",
                  flight.fit_percent, flight.left_out_percent);
    out << "    " << flight.source << " ";
    for (const FittedParameter& parameter : flight.parameters) {
      if (parameter.name == "offset") continue;
      out << " " << parameter.name << " " << valueText(parameter.value, parameter.half_width)
          << (parameter.unit == "s" ? " s" : "");
    }
    out << fits;
  }
}

}  // namespace

std::string toYaml(const AttitudeCalibration& calibration) {
  std::ostringstream out;
  out << "# Inner loops as identified from flight; calibration/README.md explains every key.\n"
      << "polyfly_calibration: 1\nkind: attitude\ntool_version: " << yamlString(kIdentificationVersion)
      << "\ndata:\n";
  writeProvenance("training", calibration.training, out);
  if (calibration.validation) writeProvenance("validation", {*calibration.validation}, out);
  if (!calibration.remarks.empty()) {
    out << "remarks:\n";
    for (const std::string& sentence : calibration.remarks) out << "  - " << yamlString(sentence) << "\n";
  }
  out << "axes:" << (calibration.axes.empty() ? " {}" : "") << "\n";
  for (const AxisModel& axis : calibration.axes) writeAxis(axis, out);
  if (!calibration.failed.empty()) {
    out << "failed:\n";
    for (const std::string& sentence : calibration.failed) out << "  - " << yamlString(sentence) << "\n";
  }
  return out.str();
}

std::string toText(const AttitudeCalibration& calibration) {
  std::ostringstream out;
  for (const std::string& sentence : calibration.remarks) out << "note: " << sentence << "\n";
  for (const AxisModel& axis : calibration.axes) {
    out << axis.axis << " (" << axis.with_delay.samples << " samples in " << axis.segments.size()
        << (axis.segments.size() == 1 ? " stretch" : " stretches") << "; +- is half of the 95 % interval)\n"
        << row("lag and delay", axis.with_delay) << row("lag alone", axis.without_delay);
    if (axis.second_order) out << row("second order and delay", *axis.second_order);
    if (axis.validation) {
      char text[128];
      std::snprintf(text, sizeof text,
                    "  validation: %.1f %% on %s, %.1f %% on what the model was made from\n",
                    axis.validation->validation_percent,
                    axis.validation->by_flights  ? "each flight by the model of the others"
                    : axis.validation->by_halves ? "the second half"
                                                 : "the other flight",
                    axis.validation->training_percent);
      out << text;
    }
    writeSpread(axis, out);
    for (const std::string& sentence : axis.warnings) out << "  warning: " << sentence << "\n";
  }
  for (const std::string& sentence : calibration.failed) out << "not identified: " << sentence << "\n";
  return out.str();
}

}  // namespace polyfly
