#include "identification/attitude_output.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "identification/flight_phases.hpp"
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

void writeLeftOut(const std::vector<RejectedWindow>& left_out, const std::string& indent, std::ostream& out) {
  out << indent << "left_out:" << (left_out.empty() ? " []" : "") << "\n";
  for (const RejectedWindow& one : left_out) {
    out << indent << "  - {from: " << yamlNumber(one.window.from) << ", to: " << yamlNumber(one.window.to)
        << ", reason: " << yamlString(one.reason) << "}\n";
  }
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
    out << "\n";
    writeLeftOut(flight.left_out, "        ", out);
    out << "        fit_percent: " << yamlNumber(flight.fit_percent)
        << "\n        validation_percent: " << yamlNumber(flight.validation_percent)
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
  writeFlights(axis, out);
  if (axis.flights.empty()) {
    out << "    windows: ";
    writeWindows(axis.choice.windows, out);
    out << "  # [s] in the file's own time\n";
    writeLeftOut(axis.choice.rejected, "    ", out);
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

std::string row(const std::string& name, const LoopFit& fit) {
  char head[64];
  std::snprintf(head, sizeof head, "  %-22s fit %6.1f %%  ", name.c_str(), fit.fit_percent);
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
                  flight.fit_percent, flight.validation_percent);
    out << "    " << flight.source << " ";
    for (const FittedParameter& parameter : flight.parameters) {
      if (parameter.name == "offset") continue;
      out << " " << parameter.name << " " << valueText(parameter.value, parameter.half_width)
          << (parameter.unit == "s" ? " s" : "");
    }
    out << fits;
  }
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

std::string usedRow(const AxisModel& axis) {
  char text[100];
  std::snprintf(text, sizeof text, "  used: %.1f s of %.1f s in which the command moves (%.0f %%)\n",
                axis.usedTime(), axis.movingTime(), 100.0 * axis.usedTime() / axis.movingTime());
  return text;
}

}  // namespace

std::vector<std::string> leftOutClauses(const AxisModel& axis) {
  if (axis.flights.empty()) return clausesOn(axis.choice.rejected);
  std::vector<std::string> clauses;
  for (const AxisFlight& flight : axis.flights) {
    const std::string file = std::filesystem::path(flight.source).filename().string();
    for (const std::string& clause : clausesOn(flight.left_out)) clauses.push_back(file + ": " + clause);
  }
  return clauses;
}

std::string toYaml(const AttitudeCalibration& calibration) {
  std::ostringstream out;
  out << "# Inner loops as identified from flight; calibration/README.md explains every key.\n"
      << "polyfly_calibration: 1\nkind: attitude\ntool_version: " << yamlString(kIdentificationVersion)
      << "\ndata:\n";
  writeProvenance("training", calibration.training, out);
  if (calibration.validation) writeProvenance("validation", {*calibration.validation}, out);
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
    out << usedRow(axis);
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
    for (const std::string& clause : leftOutClauses(axis)) out << "  left out: " << clause << "\n";
    for (const std::string& sentence : axis.warnings) out << "  warning: " << sentence << "\n";
  }
  for (const std::string& sentence : calibration.failed) out << "not identified: " << sentence << "\n";
  return out.str();
}

}  // namespace polyfly
