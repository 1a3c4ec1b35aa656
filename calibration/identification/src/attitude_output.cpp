#include "identification/attitude_output.hpp"

#include <cmath>
#include <filesystem>
#include <sstream>

#include "identification/flight_phases.hpp"
#include "identification/yaml_text.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

constexpr double kGravity = 9.8066;  // [m/s^2]

std::string nameOfFile(const AxisModel& flight) {
  return std::filesystem::path(flight.source).filename().string();
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

std::string intervalOf(const FittedParameter& parameter) {
  return "[" + yamlNumber(parameter.least()) + ", " + yamlNumber(parameter.greatest()) + "]";
}

void writeFlight(const AxisModel& flight, std::ostream& out) {
  out << "      - file: " << yamlString(nameOfFile(flight))
      << "\n        windows: " << windowList(flight.choice.windows) << "\n";
  writeLeftOut(flight.choice.rejected, "        ", out);
  out << "        fit_percent: " << yamlNumber(flight.with_delay.fit_percent) << "\n        parameters:\n";
  for (const FittedParameter& parameter : flight.with_delay.parameters) {
    out << "          " << parameter.name << ": {value: " << yamlNumber(parameter.value)
        << ", interval_95: " << intervalOf(parameter) << "}\n";
  }
}

const char* purposeOf(const std::string& key) {
  if (key == "model_without_delay") return "Eq. 37 as problem files take it: the delay counted as lag";
  if (key == "model_second_order") return "Eq. 45 with delay, for a guidance that compensates it";
  if (key == "model_second_order_without_delay") return "Eq. 45 for one that does not";
  return "Eq. 37 with delay, for a controller that compensates it";
}

// One model in the form in which a controller takes it, and what it is worth.
void writeControllerModel(const AxisModel& axis, const ControllerModel& model, std::ostream& out) {
  out << "    " << model.key << ":  # "
      << (axis.axis == "thrust" ? "m/s^2 per command" : purposeOf(model.key)) << "\n";
  std::string intervals;
  for (const FittedParameter& one : model.fit.parameters) {
    out << "      " << one.name << ": " << yamlNumber(one.value) << "\n";
    intervals += (intervals.empty() ? "" : ", ") + one.name + ": " + intervalOf(one);
  }
  out << "      intervals_95: {" << intervals << "}\n      fit_percent: " << yamlNumber(model.fit.fit_percent)
      << "\n";
  if (model.validation)
    out << "      validation_percent: " << yamlNumber(model.validation->validation_percent) << "\n";
  out << "      supported: " << (model.supported() ? "true" : "false") << "\n";
  writeSentences("reasons", "      ", model.reasons, out);
}

// The command that holds the vehicle, of a model of thrust.
double hoverCommand(const LoopFit& fit) { return (kGravity - fit.offset) / fit.gain; }

void writeAxis(const AxisModel& axis, std::ostream& out) {
  out << "  " << axis.axis << ":\n    unit: " << yamlString(axis.unit)
      << "\n    supported: " << (axis.supported ? "true" : "false")
      << "  # that of the model which problem files take\n";
  for (const ControllerModel& model : axis.controller_models) writeControllerModel(axis, model, out);
  if (axis.axis == "thrust") {
    out << "    hover_command: " << yamlNumber(hoverCommand(axis.with_delay))
        << "  # where the model holds 9.8066 m/s^2\n";
  }
  if (axis.flights.empty()) {
    out << "    windows: " << windowList(axis.choice.windows) << "  # [s] in the file's own time\n";
    writeLeftOut(axis.choice.rejected, "    ", out);
  } else {
    out << "    flights:\n";
    for (const AxisModel& flight : axis.flights) writeFlight(flight, out);
  }
  out << "    samples: " << axis.with_delay.samples << "\n";
  if (axis.validation) {
    out << "    validation: {training_percent: " << yamlNumber(axis.validation->training_percent)
        << ", validation_percent: " << yamlNumber(axis.validation->validation_percent)
        << ", by_halves: " << (axis.validation->by_halves ? "true" : "false")
        << ", by_flights: " << (axis.validation->by_flights ? "true" : "false") << "}\n";
  }
  writeSentences("warnings", "    ", axis.warnings, out);
}

// Without a zero before the point.
std::string shortNumber(double value) {
  std::string number = sentence(std::abs(value) < 1.0 ? "%.3f" : "%.4g", value);
  const std::size_t zero = number.find("0.");
  if (zero == 0 || (zero == 1 && number[0] == '-')) number.erase(zero, 1);
  return number;
}

// What people call the parameter of a loop.
std::string wordFor(const std::string& parameter) { return parameter == "tau" ? "lag" : parameter; }

// The numbers of a model, and half of each interval.
struct NumbersText {
  std::string values;
  std::string half_widths;
};

NumbersText numbersOf(const LoopFit& fit) {
  NumbersText text;
  for (const FittedParameter& one : fit.parameters) {
    if (one.name == "offset") continue;
    const std::string unit = one.unit.empty() || one.unit == "1" ? "" : " " + one.unit;
    text.values +=
        (text.values.empty() ? "" : ", ") + wordFor(one.name) + " " + shortNumber(one.value) + unit;
    text.half_widths += (text.half_widths.empty() ? "" : ", ") +
                        (std::isfinite(one.half_width) ? shortNumber(one.half_width) + unit : "unknown");
  }
  return text;
}

const char* validatedOn(const AxisValidationFit& validation) {
  if (validation.by_flights) return "on each flight by the others";
  return validation.by_halves ? "on the second half" : "on the other flight";
}

void writeSecondOrder(const AxisModel& axis, std::ostream& out) {
  for (const ControllerModel& model : axis.controller_models) {
    if (model.fit.shape.order == LoopOrder::kSecond)
      out << "  " << model.title << ": " << numbersOf(model.fit).values
          << (model.supported() ? ", supported\n" : ", NOT SUPPORTED\n");
    for (const std::string& sentence : model.reasons) out << "  " << model.key << ": " << sentence << "\n";
  }
}

}  // namespace

std::string answerOf(const AxisModel& axis) {
  const NumbersText numbers = numbersOf(axis.with_delay);
  std::string answer = axis.axis + ": " + numbers.values;
  if (axis.axis == "thrust") answer += ", hover command " + shortNumber(hoverCommand(axis.with_delay));
  answer += axis.supported ? ", supported" : ", NOT SUPPORTED";
  answer += sentence(" (%.0f of %.0f s)\n  +- ", axis.usedTime(), axis.movingTime()) + numbers.half_widths +
            sentence("; fit %.1f %%", axis.with_delay.fit_percent);
  if (!axis.validation) return answer;
  return answer + sentence(", %.1f %% ", axis.validation->validation_percent) + validatedOn(*axis.validation);
}

std::vector<std::string> leftOutClauses(const AxisModel& axis) {
  std::vector<std::string> clauses = clausesOn(axis.choice.rejected);
  for (const AxisModel& flight : axis.flights) {
    for (const std::string& clause : clausesOn(flight.choice.rejected))
      clauses.push_back(nameOfFile(flight) + ": " + clause);
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
  if (!calibration.remarks.empty()) writeSentences("remarks", "", calibration.remarks, out);
  out << "axes:" << (calibration.axes.empty() ? " {}" : "") << "\n";
  for (const AxisModel& axis : calibration.axes) writeAxis(axis, out);
  if (!calibration.failed.empty()) writeSentences("failed", "", calibration.failed, out);
  return out.str();
}

std::string toText(const AttitudeCalibration& calibration) {
  std::ostringstream out;
  for (const std::string& sentence : calibration.remarks) out << "note: " << sentence << "\n";
  for (const AxisModel& axis : calibration.axes) {
    out << answerOf(axis) << "\n";
    writeSecondOrder(axis, out);
    for (const std::string& clause : leftOutClauses(axis)) out << "  left out: " << clause << "\n";
    for (const std::string& sentence : axis.warnings) out << "  warning: " << sentence << "\n";
  }
  for (const std::string& sentence : calibration.failed) out << "not identified: " << sentence << "\n";
  return out.str();
}

}  // namespace polyfly
