#include "mpc_core/apply_calibration.hpp"

#include <numeric>
#include <utility>
#include <vector>

#include "mpc_core/yaml_edits.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// The model of a problem file, and what is to be replaced in it.
class ProblemText {
 public:
  ProblemText(const std::string& text, const std::string& source)
      : edits_(text, source), root_(edits_.root()) {
    if (!root_["model"].IsMap()) edits_.refuse("model", "missing");
  }

  const std::string& source() const { return edits_.source(); }
  YamlEdits& edits() { return edits_; }

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
    return edits_.numberOf(node(matrix, row, column), std::string("model.") + matrix);
  }

  void setEntry(const char* matrix, int row, int column, double value) {
    if (root_["model"]["time"] && root_["model"]["time"].as<std::string>("") == "discrete")
      edits_.refuse("model.time",
                    "must be continuous: calibrations have rates of a model in continuous time");
    edits_.setNumber(
        node(matrix, row, column),
        std::string("model.") + matrix + "[" + std::to_string(row) + "][" + std::to_string(column) + "]",
        value);
  }

  // A reference of a robust problem names the state that its input holds: there the gain stands a second time.
  void setReferenceGain(int lag, int input, double gain) {
    const YAML::Node parameters = root_["parameters"];
    for (std::size_t index = 0; parameters && index < parameters.size(); ++index) {
      const YAML::Node state = parameters[index]["state"];
      const YAML::Node command = parameters[index]["input"];
      if (!state || !command || lag >= static_cast<int>(state.size()) ||
          input >= static_cast<int>(command.size()))
        continue;
      const std::string field = "parameters[" + std::to_string(index) + "]";
      const double held = edits_.numberOf(command[input], field + ".input");
      if (held != 0.0)
        edits_.setNumber(state[lag], field + ".state[" + std::to_string(lag) + "]", gain * held);
    }
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
      edits_.setNumber(range[0], "model.disturbances." + name + ".range[0]", least);
      edits_.setNumber(range[1], "model.disturbances." + name + ".range[1]", greatest);
      return true;
    }
    return false;
  }

  // Whether the file states the key `delay`: then the controller predicts over it, and the lag does not hold it.
  bool statesDelay() const { return root_["model"]["delay"].IsDefined(); }
  void setDelay(double value) {
    if (!(value >= 0.0)) edits_.refuse("model.delay", "cannot be below 0, as the calibration has it");
    edits_.setNumber(root_["model"]["delay"], "model.delay", value);
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

 private:
  YAML::Node node(const char* matrix, int row, int column) const {
    const YAML::Node rows = root_["model"][matrix];
    const bool there = rows && rows.IsSequence() && row < static_cast<int>(rows.size()) &&
                       rows[row].IsSequence() && column < static_cast<int>(rows[row].size());
    if (!there) {
      edits_.refuse(std::string("model.") + matrix, "must have an entry in row " + std::to_string(row) +
                                                        ", column " + std::to_string(column));
    }
    return rows[row][column];
  }

  YamlEdits edits_;
  YAML::Node root_;
};

void applyAttitude(const CalibrationDocument& calibration, ProblemText* problem) {
  struct Loop {
    const char* input;
    const char* axis;
  };
  const bool delayed = problem->statesDelay();
  std::vector<double> delays;
  for (const Loop& loop : {Loop{"phi_cmd", "roll"}, Loop{"theta_cmd", "pitch"}}) {
    const int input = problem->indexOf("inputs", loop.input);
    if (input < 0 || !calibration.has({"axes", loop.axis})) continue;
    const int lag = problem->lagOf(input);
    if (lag < 0)
      problem->edits().refuse("model.A", std::string("has no state that lags ") + loop.input + " alone");
    const std::vector<std::string> place = {"axes", loop.axis, delayed ? "model" : "model_without_delay"};
    const double gain = calibration.supportedAbove0(place, "gain", ": wrong sign or frame");
    const double tau = calibration.supportedAbove0(place, "tau", "");
    problem->setEntry("A", lag, lag, -1.0 / tau);
    problem->setEntry("B", lag, input, gain / tau);
    problem->setReferenceGain(lag, input, gain);
    if (delayed) delays.push_back(calibration.supported(place, "delay"));
  }
  if (!delays.empty())
    problem->setDelay(std::accumulate(delays.begin(), delays.end(), 0.0) /
                      static_cast<double>(delays.size()));
}

void applyDrag(const CalibrationDocument& calibration, ProblemText* problem) {
  for (const char* letter : {"x", "y", "z"}) {
    const std::string name = std::string("drag_") + letter;
    const int state = problem->stateOf(std::string("e_v_") + letter);
    if (state < 0 || !calibration.has({"parameters", name})) continue;
    // 0 - 0 is written as 0.
    problem->setEntry("A", state, state, 0.0 - calibration.positiveParameter(name));
  }
}

void applyDisturbance(const CalibrationDocument& calibration, ProblemText* problem) {
  for (const auto& [axis, range] : calibration.disturbances()) {
    if (problem->setRange("_" + axis, range.first, range.second)) calibration.requireSupport({"axes", axis});
  }
}

}  // namespace

AppliedCalibration applyCalibrations(const std::string& problem, const std::string& source,
                                     const std::vector<CalibrationFile>& calibrations) {
  ProblemText text(problem, source);
  std::string provenance;
  for (const CalibrationFile& file : calibrations) {
    const CalibrationDocument calibration(file);
    calibration.requireVehicle("multirotor", source);
    const std::string& kind = calibration.kind();
    if (kind == "attitude") applyAttitude(calibration, &text);
    if (kind == "drag") applyDrag(calibration, &text);
    if (kind == "disturbance") applyDisturbance(calibration, &text);
    const std::vector<std::string> fields = text.edits().takeFields();
    if (fields.empty())
      throw Error(file.source + ": kind " + kind + ": has nothing for the problem " + source);
    provenance += calibration.provenanceEntry(fields);
  }
  std::string result = text.edits().finish();
  const bool known =
      result.rfind("provenance:\n", 0) == 0 || result.find("\nprovenance:\n") != std::string::npos;
  // A problem that was calibrated before ends with its provenance, to which this is added.
  result += (known ? "" : "\nprovenance:\n") + provenance;
  return {result, text.edits().changes()};
}

}  // namespace polyfly
