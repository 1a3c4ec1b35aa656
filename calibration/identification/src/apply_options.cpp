#include "identification/apply_options.hpp"

#include <algorithm>
#include <initializer_list>

#include "mpc_core/yaml_edits.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr const char* kProvenanceOption = "provenance";

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

void putLoops(const CalibrationDocument& calibration, YamlEdits* edits) {
  for (const std::string axis : {"roll", "pitch"}) {
    if (!calibration.has({"axes", axis})) continue;
    const std::vector<std::string> place = {"axes", axis, "model_without_delay"};
    edits->putNumber("nonlinear", axis + "_gain",
                     calibration.supportedAbove0(place, "gain", ": wrong sign or frame"));
    edits->putNumber("nonlinear", axis + "_time", calibration.supportedAbove0(place, "tau", ""));
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
    const std::vector<std::string> fields = edits.takeFields();
    if (fields.empty())
      throw Error(file.source + ": kind " + kind + ": has nothing for the options of " + source);
    provenance += (provenance.empty() ? "" : "; ") + calibration.provenanceText(fields);
  }
  putProvenance(provenance, &edits);
  return {edits.finish(), edits.changes(), wing};
}

}  // namespace polyfly
