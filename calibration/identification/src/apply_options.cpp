#include "identification/apply_options.hpp"

#include <algorithm>
#include <initializer_list>
#include <numeric>
#include <string>
#include <vector>

#include "mpc_core/yaml_edits.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr const char* kProvenanceOption = "provenance";
// Thrusts at which a curve is tested.
constexpr int kCurveProbes = 1000;

bool hasAny(const YamlEdits& edits, std::initializer_list<const char*> groups) {
  const YAML::Node& root = edits.root();
  return std::any_of(groups.begin(), groups.end(),
                     [&root](const char* group) { return root[group].IsDefined(); });
}

bool isFixedWing(const YamlEdits& edits) {
  const bool wing = hasAny(edits, {"model", "guidance", "safety", "path"});
  const bool rotor = hasAny(edits, {"vehicle", "controller", "nonlinear", "linear", "output"});
  if (wing == rotor) {
    throw Error(edits.source() +
                ": must hold groups of a multirotor's options (vehicle, controller, nonlinear) or of a fixed "
                "wing's (model, guidance), and not of both");
  }
  return wing;
}

// Whether the options state how long commands take to act: then the laws predict over it, and the lag does not hold it.
bool statesDelay(const YamlEdits& edits) {
  const YAML::Node& root = edits.root();
  const YAML::Node vehicle = root["vehicle"];
  return vehicle.IsDefined() && vehicle.IsMap() && vehicle["delay"].IsDefined();
}

// One message commands roll and pitch, so there is one delay: the mean of theirs.
void putLoops(const CalibrationDocument& calibration, YamlEdits* edits) {
  const bool delayed = statesDelay(*edits);
  std::vector<double> delays;
  for (const std::string axis : {"roll", "pitch"}) {
    if (!calibration.has({"axes", axis})) continue;
    const std::vector<std::string> place = {"axes", axis, delayed ? "model" : "model_without_delay"};
    edits->putNumber("nonlinear", axis + "_gain",
                     calibration.supportedAbove0(place, "gain", ": wrong sign or frame"));
    edits->putNumber("nonlinear", axis + "_time", calibration.supportedAbove0(place, "tau", ""));
    if (delayed) delays.push_back(calibration.supported(place, "delay"));
  }
  if (!delays.empty()) {
    edits->putNumber("vehicle", "delay",
                     std::accumulate(delays.begin(), delays.end(), 0.0) / static_cast<double>(delays.size()));
  }
}

void putRotorDrag(const CalibrationDocument& calibration, YamlEdits* edits) {
  struct Drag {
    const char* parameter;
    const char* option;
  };
  for (const Drag& drag :
       {Drag{"drag_forward", "drag_x"}, Drag{"drag_left", "drag_y"}, Drag{"drag_z", "drag_z"}}) {
    if (calibration.has({"parameters", drag.parameter}))
      edits->putNumber("nonlinear", drag.option, calibration.positiveParameter(drag.parameter));
  }
}

void putMass(const CalibrationDocument& calibration, YamlEdits* edits) {
  if (calibration.has({"parameters", "mass"}))
    edits->putNumber("vehicle", "mass", calibration.positiveParameter("mass"));
  if (calibration.has({"parameters", "hover_command"}))
    edits->putNumber("output", "hover_thrust", calibration.positiveParameter("hover_command"));
}

double statedNumber(const YamlEdits& edits, const std::string& group, const std::string& key) {
  const YAML::Node& root = edits.root();
  const YAML::Node map = root[group];
  const std::string field = group + "/" + key;
  if (!map.IsDefined() || !map.IsMap() || !map[key].IsDefined())
    edits.refuse(field, "must be stated: the thrust curve is tested over what the controller may ask for");
  return edits.numberOf(map[key], field);
}

// Whether the node takes the curve between these thrusts: it must rise, within 0 and 1.
bool isUsable(const std::vector<double>& polynomial, double least, double greatest) {
  double before = -1.0;
  for (int i = 0; i <= kCurveProbes; ++i) {
    const double thrust = least + (greatest - least) * i / kCurveProbes;
    double command = 0.0;
    for (auto c = polynomial.rbegin(); c != polynomial.rend(); ++c) command = command * thrust + *c;
    if (!(command > before && command >= 0.0 && command <= 1.0)) return false;
    before = command;
  }
  return true;
}

std::vector<double> numbersOf(const YamlField& list) {
  std::vector<double> numbers;
  for (const YamlField& one : list.items()) numbers.push_back(one.number());
  return numbers;
}

// The curve, and what it needs: the output that has it, and the mass by which its thrusts were computed.
void putThrustCurve(const CalibrationDocument& calibration, YamlEdits* edits) {
  calibration.requireSupport({"curve"});
  const YamlField curve = calibration.at({"curve"});
  const std::vector<double> polynomial = numbersOf(curve.at("polynomial"));
  const std::vector<double> thrusts = numbersOf(curve.at("thrusts"));
  if (polynomial.size() < 2) curve.at("polynomial").fail("must have two coefficients or more");
  if (thrusts.size() < 2) curve.at("thrusts").fail("must have two thrusts or more");
  const double mass = curve.at("mass").number();
  if (!(mass > 0.0)) curve.at("mass").fail("must be greater than 0");
  const double least = mass * statedNumber(*edits, "controller", "thrust_min");
  const double greatest = mass * statedNumber(*edits, "controller", "thrust_max");
  if (!isUsable(polynomial, least, greatest)) {
    edits->refuse("controller/thrust_min, controller/thrust_max",
                  "the curve must rise from 0 to 1 at most over what the controller may ask for, " +
                      eightDigits(least) + " to " + eightDigits(greatest) + " N; it was flown from " +
                      eightDigits(thrusts.front()) + " to " + eightDigits(thrusts.back()) + " N, which is " +
                      eightDigits(thrusts.front() / mass) + " to " + eightDigits(thrusts.back() / mass) +
                      " m/s^2");
  }
  std::string validity =
      "flown at " + eightDigits(thrusts.front()) + " to " + eightDigits(thrusts.back()) + " N";
  if (curve.has("voltage_range")) {
    const std::vector<double> range = numbersOf(curve.at("voltage_range"));
    if (range.size() != 2) curve.at("voltage_range").fail("must be [least, greatest]");
    validity += " and " + eightDigits(range[0]) + " to " + eightDigits(range[1]) + " V";
  } else {
    validity += " and a voltage that is not known";
  }
  edits->putNumbers("output", "thrust_polynomial", polynomial, validity);
  edits->putFlag("output", "attitude_target", true);
  edits->putNumber("vehicle", "mass", mass);
}

// Whether the guidance predicts over a delay: then its model may hold one.
bool compensatesDelay(const YamlEdits& edits) {
  const YAML::Node& root = edits.root();
  const YAML::Node guidance = root["guidance"];
  if (!guidance.IsDefined() || !guidance.IsMap()) return false;
  const YAML::Node move = guidance["applied_move"];
  return move.IsDefined() && edits.numberOf(move, "guidance/applied_move") == 0.0;
}

void putRollLoop(const CalibrationDocument& calibration, YamlEdits* edits) {
  if (!calibration.has({"axes", "roll"})) return;
  const bool delayed = compensatesDelay(*edits);
  const std::vector<std::string> place = {
      "axes", "roll", delayed ? "model_second_order" : "model_second_order_without_delay"};
  for (const char* key : {"a0", "a1", "b0"})
    edits->putNumber("model", key, calibration.supportedAbove0(place, key, ""));
  if (delayed) edits->putNumber("guidance", "delay", calibration.supported(place, "delay"));
}

void putProvenance(const std::string& text, YamlEdits* edits) {
  const YAML::Node& root = edits->root();
  const YAML::Node before = root[kProvenanceOption];
  edits->putText(kProvenanceOption,
                 before.IsDefined() && before.IsScalar() ? before.as<std::string>() + "; " + text : text);
}

}  // namespace

AppliedOptions applyToOptions(const std::string& options, const std::string& source,
                              const std::vector<CalibrationFile>& calibrations) {
  YamlEdits edits(options, source);
  const bool wing = isFixedWing(edits);
  std::string provenance;
  for (const CalibrationFile& file : calibrations) {
    const CalibrationDocument calibration(file);
    calibration.requireVehicle(wing ? "fixed_wing" : "multirotor", source);
    const std::string& kind = calibration.kind();
    if (kind == "attitude" && wing) putRollLoop(calibration, &edits);
    if (kind == "attitude" && !wing) putLoops(calibration, &edits);
    if (kind == "drag" && !wing) putRotorDrag(calibration, &edits);
    if (kind == "mass" && !wing) putMass(calibration, &edits);
    if (kind == "thrust" && !wing) putThrustCurve(calibration, &edits);
    const std::vector<std::string> fields = edits.takeFields();
    if (fields.empty())
      throw Error(file.source + ": kind " + kind + ": has nothing for the options of " + source);
    provenance += (provenance.empty() ? "" : "; ") + calibration.provenanceText(fields);
  }
  putProvenance(provenance, &edits);
  return {edits.finish(), edits.changes(), wing};
}

}  // namespace polyfly
