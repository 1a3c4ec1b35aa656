#include "calibration_keys.hpp"

#include <initializer_list>

namespace polyfly {
namespace {

// One flight, or a list of several.
void checkFlights(const YamlField& flights) {
  for (const YamlField& flight : flights.isList() ? flights.items() : std::vector<YamlField>{flights})
    flight.checkKeys({"file"}, {"checksum", "recorded"});
}

void checkData(const YamlField& data) {
  if (data.isList() || !data.has("training")) {
    checkFlights(data);
    return;
  }
  data.checkKeys({"training"}, {"validation"});
  for (const char* flights : {"training", "validation"}) {
    if (data.has(flights)) checkFlights(data.at(flights));
  }
}

void checkFit(const YamlField& fit) {
  fit.checkKeys({}, {"fit_percent", "residual_rms", "parameters", "correlation"});
  if (!fit.has("parameters")) return;
  const YamlField parameters = fit.at("parameters");
  parameters.checkKeys({}, {"gain", "tau", "delay", "offset", "a0", "a1", "b0"});
  for (const char* name : {"gain", "tau", "delay", "offset", "a0", "a1", "b0"}) {
    if (parameters.has(name))
      parameters.at(name).checkKeys({"value"}, {"standard_error", "interval_95", "between_flights"});
  }
}

// What was left out: of the axis, or of each of its flights.
void checkLeftOut(const YamlField& holder) {
  if (!holder.has("left_out")) return;
  for (const YamlField& one : holder.at("left_out").items()) one.checkKeys({"from", "to"}, {"reason"});
}

void checkAxisFlight(const YamlField& flight) {
  flight.checkKeys({"file"}, {"windows", "left_out", "fit_percent", "validation_percent", "parameters"});
  checkLeftOut(flight);
  if (!flight.has("parameters")) return;
  const YamlField parameters = flight.at("parameters");
  parameters.checkKeys({}, {"gain", "tau", "delay", "offset"});
  for (const char* name : {"gain", "tau", "delay", "offset"}) {
    if (parameters.has(name)) parameters.at(name).checkKeys({"value"}, {"interval_95"});
  }
}

void checkAttitudeAxis(const YamlField& axis) {
  axis.checkKeys({}, {"unit", "supported", "model", "model_without_delay", "model_second_order",
                      "model_second_order_without_delay", "greatest_rate", "hover_command",
                      "interval_holds_for", "flights", "windows", "left_out", "samples", "validation",
                      "with_delay", "without_delay", "second_order", "warnings"});
  for (const char* model :
       {"model", "model_without_delay", "model_second_order", "model_second_order_without_delay"}) {
    if (!axis.has(model)) continue;
    axis.at(model).checkKeys({}, {"gain", "tau", "delay", "offset", "a0", "a1", "b0", "intervals_95",
                                  "fit_percent", "validation_percent", "supported", "reasons"});
  }
  if (axis.has("validation")) {
    axis.at("validation")
        .checkKeys({}, {"training_percent", "validation_percent", "by_halves", "by_flights"});
  }
  checkLeftOut(axis);
  if (axis.has("flights")) {
    for (const YamlField& flight : axis.at("flights").items()) checkAxisFlight(flight);
  }
  for (const char* fit : {"with_delay", "without_delay", "second_order"}) {
    if (axis.has(fit)) checkFit(axis.at(fit));
  }
}

void checkAttitude(const YamlField& root) {
  root.checkKeys({"polyfly_calibration", "kind", "data", "axes"},
                 {"tool_version", "vehicle", "remarks", "failed"});
  const YamlField axes = root.at("axes");
  axes.checkKeys({}, {"roll", "pitch", "yaw_rate", "thrust"});
  for (const char* axis : {"roll", "pitch", "yaw_rate", "thrust"}) {
    if (axes.has(axis)) checkAttitudeAxis(axes.at(axis));
  }
}

void checkDisturbance(const YamlField& root) {
  root.checkKeys({"polyfly_calibration", "kind", "data", "disturbances"},
                 {"tool_version", "vehicle", "windows", "interval_holds_for", "remarks", "share",
                  "confidence", "axes", "warnings"});
  for (const YamlField& one : root.at("disturbances").items()) one.checkKeys({"name", "range"}, {"unit"});
  if (!root.has("axes")) return;
  const YamlField axes = root.at("axes");
  axes.checkKeys({}, {"x", "y", "z"});
  for (const char* axis : {"x", "y", "z"}) {
    if (!axes.has(axis)) continue;
    axes.at(axis).checkKeys(
        {}, {"mean", "deviation", "supported", "confidence", "independent_samples", "quantiles", "warnings"});
  }
}

constexpr std::initializer_list<const char*> kMotionParameters = {
    "drag_x",   "drag_y",   "drag_z", "drag_forward", "drag_left",    "offset_x",
    "offset_y", "offset_z", "mass",   "hover_thrust", "hover_command"};

void checkParameters(const YamlField& root) {
  const YamlField parameters = root.at("parameters");
  parameters.checkKeys({}, kMotionParameters);
  for (const char* name : kMotionParameters) {
    if (!parameters.has(name)) continue;
    parameters.at(name).checkKeys({"value"},
                                  {"unit", "standard_error", "interval_95", "supported", "between_flights"});
  }
  if (!root.has("flights")) return;
  for (const YamlField& flight : root.at("flights").items()) flight.checkKeys({"file"}, kMotionParameters);
}

// Kinds that hold fitted parameters.
void checkMotion(const YamlField& root) {
  root.checkKeys(
      {"polyfly_calibration", "kind", "data", "parameters"},
      {"tool_version", "vehicle", "windows", "interval_holds_for", "remarks", "flights", "warnings"});
  checkParameters(root);
}

}  // namespace

void checkCalibrationKeys(const YamlField& root, const std::string& kind) {
  if (kind == "attitude") {
    checkAttitude(root);
  } else if (kind == "disturbance") {
    checkDisturbance(root);
  } else {
    checkMotion(root);
  }
  checkData(root.at("data"));
  if (root.has("vehicle")) root.at("vehicle").checkKeys({"kind"}, {"reason"});
}

}  // namespace polyfly
