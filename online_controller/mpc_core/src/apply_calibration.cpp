#include "mpc_core/apply_calibration.hpp"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <locale>
#include <sstream>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kSameNumber = 1e-12;  // relative, of numbers that are written alike

std::string shortest(double value) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out << std::setprecision(8) << value;
  return out.str();
}

// The text of a problem, and what is to be replaced in it.
class ProblemText {
 public:
  ProblemText(std::string text, std::string source) : text_(std::move(text)), source_(std::move(source)) {
    try {
      root_ = YAML::Load(text_);
    } catch (const YAML::Exception& failure) {
      throw Error(source_ + ": is no YAML: " + failure.what());
    }
    if (!root_.IsMap() || !root_["model"].IsMap()) refuse("model", "missing");
  }

  [[noreturn]] void refuse(const std::string& field, const std::string& rule) const {
    throw Error(source_ + ": " + field + ": " + rule);
  }

  // Index of the signal with this name in a list of the model, or -1.
  int indexOf(const char* list, const std::string& name) const {
    const YAML::Node signals = root_["model"][list];
    for (std::size_t index = 0; signals && index < signals.size(); ++index) {
      if (signals[index]["name"].as<std::string>("") == name) return static_cast<int>(index);
    }
    return -1;
  }

  // Index of the state that a parameter with role error is of, or -1.
  int stateOf(const std::string& parameter) const {
    const YAML::Node parameters = root_["parameters"];
    for (std::size_t index = 0; parameters && index < parameters.size(); ++index) {
      if (parameters[index]["name"].as<std::string>("") != parameter) continue;
      return indexOf("states", parameters[index]["of"].as<std::string>(""));
    }
    return -1;
  }

  double entry(const char* matrix, int row, int column) const {
    return numberOf(node(matrix, row, column), matrix);
  }

  void setEntry(const char* matrix, int row, int column, double value) {
    set(node(matrix, row, column),
        std::string("model.") + matrix + "[" + std::to_string(row) + "][" + std::to_string(column) + "]",
        value);
  }

  // Ends of the range of the disturbance whose name ends so; whether there is one.
  bool setRange(const std::string& ending, double least, double greatest) {
    const YAML::Node signals = root_["model"]["disturbances"];
    for (std::size_t index = 0; signals && index < signals.size(); ++index) {
      const std::string name = signals[index]["name"].as<std::string>("");
      const YAML::Node range = signals[index]["range"];
      const bool fits = name.size() > ending.size() &&
                        name.compare(name.size() - ending.size(), ending.size(), ending) == 0;
      if (!fits || !range || range.size() != 2) continue;
      set(range[0], "model.disturbances." + name + ".range[0]", least);
      set(range[1], "model.disturbances." + name + ".range[1]", greatest);
      return true;
    }
    return false;
  }

  // Index of a lag's state: the row of the input in B with a diagonal entry of A only.
  int lagOf(int input) const {
    const YAML::Node a = root_["model"]["A"];
    for (int row = 0; row < static_cast<int>(a.size()); ++row) {
      if (entry("B", row, input) == 0.0) continue;
      bool alone = true;
      for (int column = 0; column < static_cast<int>(a.size()); ++column) {
        alone = alone && (column == row || entry("A", row, column) == 0.0);
      }
      if (alone && entry("A", row, row) < 0.0) return row;
    }
    return -1;
  }

  const std::vector<std::string>& changes() const { return changes_; }
  std::vector<std::string> takeFields() { return std::move(fields_); }

  std::string finish() const {
    std::vector<Edit> edits = edits_;
    std::sort(edits.begin(), edits.end(),
              [](const Edit& one, const Edit& other) { return one.place > other.place; });
    std::string text = text_;
    for (const Edit& edit : edits) text.replace(edit.place, edit.length, edit.number);
    return text;
  }

 private:
  struct Edit {
    std::size_t place;
    std::size_t length;
    std::string number;
  };

  YAML::Node node(const char* matrix, int row, int column) const {
    const YAML::Node rows = root_["model"][matrix];
    const bool there = rows && rows.IsSequence() && row < static_cast<int>(rows.size()) &&
                       rows[row].IsSequence() && column < static_cast<int>(rows[row].size());
    if (!there) {
      refuse(std::string("model.") + matrix,
             "must have an entry in row " + std::to_string(row) + ", column " + std::to_string(column));
    }
    return rows[row][column];
  }

  double numberOf(const YAML::Node& scalar, const char* field) const {
    try {
      return scalar.as<double>();
    } catch (const YAML::Exception&) {
      refuse(std::string("model.") + field, "must hold numbers");
    }
  }

  void set(const YAML::Node& scalar, const std::string& field, double value) {
    const double before = numberOf(scalar, field.c_str());
    fields_.push_back(field);
    if (std::abs(before - value) <= kSameNumber * std::abs(value)) return;
    const auto place = static_cast<std::size_t>(scalar.Mark().pos);
    const std::size_t end = text_.find_first_of(",]} \t\r\n#", place);
    edits_.push_back({place, end - place, shortest(value)});
    changes_.push_back(field + ": " + shortest(before) + " to " + shortest(value));
  }

  std::string text_;
  std::string source_;
  YAML::Node root_;
  std::vector<Edit> edits_;
  std::vector<std::string> changes_;
  // Fields that the present calibration set.
  std::vector<std::string> fields_;
};

double numberAt(const YAML::Node& map, const char* key, const CalibrationFile& file,
                const std::string& place) {
  try {
    const double value = map[key].as<double>();
    if (std::isfinite(value)) return value;
  } catch (const YAML::Exception&) {
  }
  throw Error(file.source + ": " + place + "." + key + ": must be a finite number");
}

// Refuses what `calibrate` found the data not to support, with its reasons.
void requireSupport(const YAML::Node& result, const CalibrationFile& file, const std::string& place) {
  if (file.force || result["supported"].as<bool>(true)) return;
  std::string reasons;
  for (const YAML::Node& warning : result["warnings"]) reasons += "\n  " + warning.as<std::string>("");
  throw Error(file.source + ": " + place +
              ": the data do not support these numbers; fly again (calibrate apply --force takes them)" +
              reasons);
}

void applyAttitude(const YAML::Node& calibration, const CalibrationFile& file, ProblemText* problem) {
  struct Loop {
    const char* input;
    const char* axis;
  };
  for (const Loop& loop : {Loop{"phi_cmd", "roll"}, Loop{"theta_cmd", "pitch"}}) {
    const int input = problem->indexOf("inputs", loop.input);
    const YAML::Node axis = calibration["axes"][loop.axis];
    if (input < 0 || !axis) continue;
    const int lag = problem->lagOf(input);
    if (lag < 0) problem->refuse("model.A", std::string("has no state that lags ") + loop.input + " alone");
    const std::string place = std::string("axes.") + loop.axis + ".model_without_delay";
    const YAML::Node model = axis["model_without_delay"];
    requireSupport(axis, file, std::string("axes.") + loop.axis);
    const double gain = numberAt(model, "gain", file, place);
    const double tau = numberAt(model, "tau", file, place);
    if (!(tau > 0.0)) throw Error(file.source + ": " + place + ".tau: must be greater than 0");
    if (!(gain > 0.0))
      throw Error(file.source + ": " + place + ".gain: must be greater than 0: wrong sign or frame");
    problem->setEntry("A", lag, lag, -1.0 / tau);
    problem->setEntry("B", lag, input, gain / tau);
  }
}

void applyDrag(const YAML::Node& calibration, const CalibrationFile& file, ProblemText* problem) {
  for (const char* letter : {"x", "y", "z"}) {
    const std::string name = std::string("drag_") + letter;
    const int state = problem->stateOf(std::string("e_v_") + letter);
    const YAML::Node drag = calibration["parameters"][name];
    if (state < 0 || !drag) continue;
    requireSupport(drag, file, "parameters." + name);
    const double value = numberAt(drag, "value", file, "parameters." + name);
    problem->setEntry("A", state, state, -std::max(0.0, value));
  }
}

void applyDisturbance(const YAML::Node& calibration, const CalibrationFile& file, ProblemText* problem) {
  for (const YAML::Node& bound : calibration["disturbances"]) {
    const std::string name = bound["name"].as<std::string>("");
    const YAML::Node range = bound["range"];
    if (name.size() < 3 || !range || range.size() != 2) {
      throw Error(file.source + ": disturbances: each must have a name and a range");
    }
    const std::string axis = name.substr(name.size() - 1);
    const bool taken = problem->setRange("_" + axis, range[0].as<double>(), range[1].as<double>());
    const YAML::Node axes = calibration["axes"];
    if (taken && axes && axes[axis]) requireSupport(axes[axis], file, "axes." + axis);
  }
}

// File, checksum and date of a flight.
std::string flightEntry(const YAML::Node& flight) {
  return yamlString(flight["file"].as<std::string>("")) + ", " +
         yamlString(flight["checksum"].as<std::string>("")) + ", " +
         yamlString(flight["recorded"].as<std::string>(""));
}

// The flights that a calibration is made from: of several a list in a list.
std::string flightEntries(const YAML::Node& calibration) {
  const YAML::Node data = calibration["data"];
  const YAML::Node flights = data.IsMap() && data["training"] ? data["training"] : data;
  if (!flights.IsSequence()) return "[" + flightEntry(flights) + "]";
  std::string text;
  for (const YAML::Node& flight : flights) text += (text.empty() ? "[[" : ", [") + flightEntry(flight) + "]";
  return text + "]";
}

// Quoted for YAML: names of files and fields have no other characters that need it.
std::string provenanceEntry(const CalibrationFile& file, const YAML::Node& calibration,
                            const std::vector<std::string>& fields) {
  std::string text = "  - {file: " + yamlString(file.provenance.file) +
                     ", checksum: " + yamlString(file.provenance.checksum) +
                     ", kind: " + calibration["kind"].as<std::string>() +
                     ",\n     tool_version: " + yamlString(calibration["tool_version"].as<std::string>("")) +
                     ", data: " + flightEntries(calibration) + ",\n     fields: [";
  for (std::size_t index = 0; index < fields.size(); ++index)
    text += (index > 0 ? ", " : "") + yamlString(fields[index]);
  return text + "]}\n";
}

}  // namespace

AppliedCalibration applyCalibrations(const std::string& problem, const std::string& source,
                                     const std::vector<CalibrationFile>& calibrations) {
  ProblemText text(problem, source);
  std::string provenance;
  for (const CalibrationFile& file : calibrations) {
    YAML::Node calibration;
    try {
      calibration = YAML::Load(file.text);
    } catch (const YAML::Exception& failure) {
      throw Error(file.source + ": is no YAML: " + failure.what());
    }
    if (!calibration.IsMap() || calibration["polyfly_calibration"].as<int>(0) != 1) {
      throw Error(file.source + ": polyfly_calibration: must be 1, as `calibrate` writes it");
    }
    const std::string kind = calibration["kind"].as<std::string>("");
    if (kind == "attitude") {
      applyAttitude(calibration, file, &text);
    } else if (kind == "drag") {
      applyDrag(calibration, file, &text);
    } else if (kind == "disturbance") {
      applyDisturbance(calibration, file, &text);
    } else {
      throw Error(file.source + ": kind: must be attitude, drag or disturbance, got '" + kind + "'");
    }
    const std::vector<std::string> fields = text.takeFields();
    if (fields.empty())
      throw Error(file.source + ": kind " + kind + ": has nothing for the problem " + source);
    provenance += provenanceEntry(file, calibration, fields);
  }
  std::string result = text.finish();
  if (!result.empty() && result.back() != '\n') result += "\n";
  const bool known =
      result.rfind("provenance:\n", 0) == 0 || result.find("\nprovenance:\n") != std::string::npos;
  // A problem that was calibrated before ends with its provenance, to which this is added.
  result += (known ? "" : "\nprovenance:\n") + provenance;
  return {result, text.changes()};
}

}  // namespace polyfly
