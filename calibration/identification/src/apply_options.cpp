#include "identification/apply_options.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "mpc_core/yaml_edits.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/provenance.hpp"

namespace polyfly {
namespace {

// Options by group, in the order in which they come.
class OptionsText {
 public:
  void put(const std::string& group, const std::string& key, double value) {
    auto found = std::find_if(groups_.begin(), groups_.end(),
                              [&group](const auto& one) { return one.first == group; });
    if (found == groups_.end()) found = groups_.insert(found, {group, {}});
    found->second += "  " + key + ": " + eightDigits(value) + "\n";
    fields_.push_back(group + "/" + key);
  }

  // Fields that were put since the last call.
  std::vector<std::string> takeFields() { return std::exchange(fields_, {}); }

  std::string text() const {
    std::string text;
    for (const auto& [group, lines] : groups_) text += group + ":\n" + lines;
    return text;
  }

 private:
  std::vector<std::pair<std::string, std::string>> groups_;
  std::vector<std::string> fields_;
};

// One message commands roll and pitch, so there is one delay: the mean of theirs.
void putLoops(const CalibrationDocument& calibration, bool delayed, OptionsText* options) {
  std::vector<double> delays;
  for (const std::string axis : {"roll", "pitch"}) {
    if (!calibration.has({"axes", axis})) continue;
    const std::vector<std::string> place = {"axes", axis, delayed ? "model" : "model_without_delay"};
    options->put("nonlinear", axis + "_gain",
                 calibration.supportedAbove0(place, "gain", ": wrong sign or frame"));
    options->put("nonlinear", axis + "_time", calibration.supportedAbove0(place, "tau", ""));
    if (delayed) delays.push_back(calibration.supported(place, "delay"));
  }
  if (!delays.empty()) {
    options->put("vehicle", "delay",
                 std::accumulate(delays.begin(), delays.end(), 0.0) / static_cast<double>(delays.size()));
  }
}

// A parameter of a calibration, and the option that takes it.
struct ParameterOption {
  const char* kind;
  const char* parameter;
  const char* group;
  const char* key;
};

constexpr ParameterOption kParameterOptions[] = {{"drag", "drag_forward", "nonlinear", "drag_x"},
                                                 {"drag", "drag_left", "nonlinear", "drag_y"},
                                                 {"drag", "drag_z", "nonlinear", "drag_z"},
                                                 {"mass", "mass", "vehicle", "mass"},
                                                 {"mass", "hover_command", "output", "hover_thrust"}};

void putParameters(const CalibrationDocument& calibration, OptionsText* options) {
  for (const ParameterOption& one : kParameterOptions) {
    if (calibration.kind() == one.kind && calibration.has({"parameters", one.parameter}))
      options->put(one.group, one.key, calibration.positiveParameter(one.parameter));
  }
}

void putRollLoop(const CalibrationDocument& calibration, OptionsText* options) {
  if (!calibration.has({"axes", "roll"})) return;
  for (const char* key : {"a0", "a1", "b0"})
    options->put("model", key,
                 calibration.supportedAbove0({"axes", "roll", "model_second_order_without_delay"}, key, ""));
}

}  // namespace

std::string optionsBlock(const OptionsTarget& target, const std::vector<CalibrationFile>& calibrations) {
  if (target.vehicle == "fixed_wing" && target.predicts_delay)
    throw Error("--predicts-delay: the guidance of a fixed_wing predicts without a delay; leave it out");
  OptionsText options;
  std::string provenance;
  for (const CalibrationFile& file : calibrations) {
    const CalibrationDocument calibration(file);
    const std::string name = "the options of a " + target.vehicle;
    calibration.requireVehicle(target.vehicle, name);
    const bool attitude = calibration.kind() == "attitude";
    if (target.vehicle == "fixed_wing") {
      if (attitude) putRollLoop(calibration, &options);
    } else if (attitude) {
      putLoops(calibration, target.predicts_delay, &options);
    } else {
      putParameters(calibration, &options);
    }
    const std::vector<std::string> fields = options.takeFields();
    if (fields.empty())
      throw Error(file.source + ": kind " + calibration.kind() + ": has nothing for " + name);
    provenance += (provenance.empty() ? "" : "; ") + calibration.provenanceText(fields);
  }
  return options.text() + "provenance: " + yamlString(provenance) + "\n";
}

}  // namespace polyfly
