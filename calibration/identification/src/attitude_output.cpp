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

const char* purposeOf(const std::string& key) {
  if (key == "model_without_delay") return "Eq. 37 as problem files take it: the delay counted as lag";
  if (key == "model_second_order") return "Eq. 45 with delay, for a guidance that compensates it";
  if (key == "model_second_order_without_delay") return "Eq. 45 for one that does not";
  return "Eq. 37 with delay, for a controller that compensates it";
}

// A number of the model with its interval, under the name of `parameter`.
void writeInterval(const FittedParameter& parameter, bool first, std::ostream& out) {
  out << (first ? "" : ", ") << parameter.name << ": [" << yamlNumber(parameter.least()) << ", "
      << yamlNumber(parameter.greatest()) << "]";
}

// One model in the form in which a controller takes it, and what it is worth.
void writeControllerModel(const AxisModel& axis, const ControllerModel& model, std::ostream& out) {
  const bool thrust = axis.axis == "thrust";
  const LoopFit& fit = model.fit;
  out << "    " << model.key << ":  # " << (thrust ? "m/s^2 per command" : purposeOf(model.key)) << "\n";
  for (const FittedParameter& one : fit.parameters) {
    if (one.name != "offset" || thrust) out << "      " << one.name << ": " << yamlNumber(one.value) << "\n";
  }
  out << "      intervals_95: {";
  bool first = true;
  for (const FittedParameter& one : fit.parameters) {
    if (one.name == "offset" && !thrust) continue;
    writeInterval(one, first, out);
    first = false;
  }
  out << "}\n      fit_percent: " << yamlNumber(fit.fit_percent) << "\n";
  if (model.validation)
    out << "      validation_percent: " << yamlNumber(model.validation->validation_percent) << "\n";
  out << "      supported: " << (model.supported() ? "true" : "false")
      << "\n      reasons:" << (model.supported() ? " []" : "") << "\n";
  for (const std::string& sentence : model.reasons) out << "        - " << yamlString(sentence) << "\n";
}

void writeModels(const AxisModel& axis, std::ostream& out) {
  for (const ControllerModel& model : axis.controller_models) writeControllerModel(axis, model, out);
  if (axis.axis != "thrust") return;
  const LoopFit& fit = axis.with_delay;
  out << "    hover_command: " << yamlNumber((kGravity - fit.offset) / fit.gain)
      << "  # where the model holds 9.8066 m/s^2\n";
}

void writeAxis(const AxisModel& axis, std::ostream& out) {
  out << "  " << axis.axis << ":\n    unit: " << yamlString(axis.unit) << "\n";
  out << "    supported: " << (axis.supported ? "true" : "false")
      << "  # that of the model which problem files take\n";
  writeModels(axis, out);
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

std::string row(const std::string& name, const LoopFit& fit) {
  char head[64];
  std::snprintf(head, sizeof head, "  %-22s fit %6.1f %%  ", name.c_str(), fit.fit_percent);
  std::string line = head;
  for (const FittedParameter& parameter : fit.parameters) {
    line += "  " + parameter.name + " " + valueText(parameter.value, parameter.half_width);
    if (!parameter.unit.empty() && parameter.unit != "1") line += " " + parameter.unit;
  }
  return line + "\n";
}

// A model with its own validation, and why it is refused.
std::string controllerRow(const ControllerModel& model) {
  std::string text = row(model.title, model.fit);
  text.pop_back();
  char validation[48] = "";
  if (model.validation) {
    std::snprintf(validation, sizeof validation, "  validation %.1f %%",
                  model.validation->validation_percent);
  }
  text += validation;
  text += model.supported() ? "  supported\n" : "  NOT SUPPORTED\n";
  for (const std::string& sentence : model.reasons) text += "    " + sentence + "\n";
  return text;
}

}  // namespace

std::string toYaml(const AttitudeCalibration& calibration) {
  std::ostringstream out;
  out << "# Inner loops as identified from flight; calibration/README.md explains every key.\n"
      << "polyfly_calibration: 1\nkind: attitude\ntool_version: " << yamlString(kIdentificationVersion)
      << "\ndata:\n";
  writeProvenance("training", calibration.training, out);
  if (calibration.validation) writeProvenance("validation", *calibration.validation, out);
  out << vehicleLine(calibration.vehicle);
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
        << row("lag alone", axis.without_delay);
    for (const ControllerModel& model : axis.controller_models) out << controllerRow(model);
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
