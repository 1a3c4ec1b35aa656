#include "identification/apply_options.hpp"

#include <numeric>
#include <string>
#include <vector>

#include "polyfly_base/error.hpp"
#include "report/report.hpp"
#include "report/yaml.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

// Options by group, and their fields.
struct Options {
  Json groups = Json::object();
  std::vector<std::string> fields;

  void put(const std::string& group, const std::string& key, double value) {
    groups[group][key] = value;
    fields.push_back(group + "/" + key);
  }
};

// One message commands roll and pitch, so there is one delay: the mean of theirs.
void putLoops(const CalibrationDocument& calibration, bool delayed, Options* options) {
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

void putParameters(const CalibrationDocument& calibration, Options* options) {
  for (const ParameterOption& one : kParameterOptions) {
    if (calibration.kind() == one.kind && calibration.has({"parameters", one.parameter}))
      options->put(one.group, one.key, calibration.positiveParameter(one.parameter));
  }
}

void putRollLoop(const CalibrationDocument& calibration, Options* options) {
  if (!calibration.has({"axes", "roll"})) return;
  for (const char* key : {"a0", "a1", "b0"})
    options->put("model", key,
                 calibration.supportedAbove0({"axes", "roll", "model_second_order_without_delay"}, key, ""));
}

}  // namespace

std::string optionsBlock(const OptionsTarget& target, const std::vector<CalibrationFile>& calibrations) {
  if (target.vehicle == "fixed_wing" && target.predicts_delay)
    throw Error("--predicts-delay: the guidance of a fixed_wing predicts without a delay; leave it out");
  Options options;
  std::vector<std::string> provenance;
  for (const CalibrationFile& file : calibrations) {
    const CalibrationDocument calibration(file);
    const std::string name = "the options of a " + target.vehicle;
    calibration.requireVehicle(target.vehicle, name);
    const bool attitude = calibration.kind() == "attitude";
    options.fields.clear();
    if (target.vehicle == "fixed_wing") {
      if (attitude) putRollLoop(calibration, &options);
    } else if (attitude) {
      putLoops(calibration, target.predicts_delay, &options);
    } else {
      putParameters(calibration, &options);
    }
    if (options.fields.empty())
      throw Error(file.source + ": kind " + calibration.kind() + ": has nothing for " + name);
    provenance.push_back(calibration.provenanceText(options.fields));
  }
  options.groups["provenance"] = listOf(provenance, "; ");
  return yamlText(options.groups);
}

}  // namespace polyfly
