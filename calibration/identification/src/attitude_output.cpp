#include "identification/attitude_output.hpp"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "identification/flight_phases.hpp"
#include "identification/yaml_text.hpp"

namespace polyfly {
namespace {

constexpr double kGravity = 9.8066;  // [m/s^2]

void writeProvenance(const char* key, const Provenance& provenance, std::ostream& out) {
  out << "  " << key << ": {file: " << yamlString(provenance.file)
      << ", checksum: " << yamlString(provenance.checksum)
      << ", recorded: " << yamlString(provenance.recorded) << "}\n";
}

void writeFit(const char* key, const LoopFit& fit, std::ostream& out) {
  out << "    " << key << ":\n      fit_percent: " << yamlNumber(fit.fit_percent)
      << "\n      residual_rms: " << yamlNumber(fit.residual_rms) << "\n      parameters:\n";
  for (const FittedParameter& parameter : fit.parameters) {
    out << "        " << parameter.name << ": {value: " << yamlNumber(parameter.value)
        << ", standard_error: " << yamlNumber(parameter.standard_error) << ", interval_95: ["
        << yamlNumber(parameter.least()) << ", " << yamlNumber(parameter.greatest()) << "]}\n";
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

void writeWindows(const AxisModel& axis, std::ostream& out) {
  out << "    windows: [";
  for (std::size_t i = 0; i < axis.choice.windows.size(); ++i) {
    const TimeWindow& window = axis.choice.windows[i];
    out << (i > 0 ? ", " : "") << "[" << yamlNumber(window.from) << ", " << yamlNumber(window.to) << "]";
  }
  out << "]  # [s] in the file's own time\n    left_out:" << (axis.choice.rejected.empty() ? " []" : "")
      << "\n";
  for (const RejectedWindow& one : axis.choice.rejected) {
    out << "      - {from: " << yamlNumber(one.window.from) << ", to: " << yamlNumber(one.window.to)
        << ", reason: " << yamlString(one.reason) << "}\n";
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
  writeWindows(axis, out);
  out << "    samples: " << axis.with_delay.samples << "\n";
  if (axis.validation) {
    out << "    validation: {training_percent: " << yamlNumber(axis.validation->training_percent)
        << ", validation_percent: " << yamlNumber(axis.validation->validation_percent)
        << ", by_halves: " << (axis.validation->by_halves ? "true" : "false") << "}\n";
  }
  writeFit("with_delay", axis.with_delay, out);
  writeFit("without_delay", axis.without_delay, out);
  if (axis.second_order) writeFit("second_order", *axis.second_order, out);
  out << "    warnings:" << (axis.warnings.empty() ? " []" : "") << "\n";
  for (const std::string& sentence : axis.warnings) out << "      - " << yamlString(sentence) << "\n";
}

std::string row(const char* name, const LoopFit& fit) {
  char head[64];
  std::snprintf(head, sizeof head, "  %-22s fit %6.1f %%  ", name, fit.fit_percent);
  std::string line = head;
  for (const FittedParameter& parameter : fit.parameters) {
    line += "  " + parameter.name + " " + valueText(parameter.value, parameter.half_width);
    if (!parameter.unit.empty() && parameter.unit != "1") line += " " + parameter.unit;
  }
  return line + "\n";
}

}  // namespace

std::string toYaml(const AttitudeCalibration& calibration) {
  std::ostringstream out;
  out << "# Inner loops as identified from flight; calibration/README.md explains every key.\n"
      << "polyfly_calibration: 1\nkind: attitude\ntool_version: " << yamlString(kIdentificationVersion)
      << "\ndata:\n";
  writeProvenance("training", calibration.training, out);
  if (calibration.validation) writeProvenance("validation", *calibration.validation, out);
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
                    axis.validation->by_halves ? "the second half" : "the other flight",
                    axis.validation->training_percent);
      out << text;
    }
    for (const std::string& clause : clausesOn(axis.choice.rejected)) out << "  left out: " << clause << "\n";
    for (const std::string& sentence : axis.warnings) out << "  warning: " << sentence << "\n";
  }
  for (const std::string& sentence : calibration.failed) out << "not identified: " << sentence << "\n";
  return out.str();
}

}  // namespace polyfly
