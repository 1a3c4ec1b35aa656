#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "nonlinear_mpc/nonlinear_mpc.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller/types/flight_options.hpp"
#include "online_controller/types/moment_model.hpp"
#include "online_controller/types/node_options.hpp"
#include "online_controller/types/options.hpp"

namespace polyfly {

/// Paths of three files: longitudinal, lateral, vertical. All empty where there are none.
using AxisPaths = std::array<std::string, 3>;

/// All that a multirotor's node reads from its private parameters.
struct MultirotorParameters {
  /// Name of the law that flies first.
  std::string law = "explicit_linear";
  std::string odometry_frame;
  /// Whether a pilot is required; not set: once one was there.
  std::optional<bool> use_rc_teleop;
  /// Where calibrated numbers come from: the text of `calibrate apply`.
  std::string provenance;
  /// Of each law that has maps, in the order of lawTypes().
  MapPaths maps = MapPaths(lawTypes().size());
  AxisPaths problems;
  MultirotorOptions controller;
  NonlinearMpcOptions nonlinear;
  LinearTuning linear{};
  MomentModel moments;
  FlightOptions flight;
  NodeOptions node;
  JoyLayout joy;
  OutputOptions output;
};

template <class Paths, class Visit>
void visitAxisPaths(const std::string& group, Paths& paths, Visit&& visit) {
  visit((group + "/longitudinal").c_str(), paths[0]);
  visit((group + "/lateral").c_str(), paths[1]);
  visit((group + "/vertical").c_str(), paths[2]);
}

/// The one list of all parameters, made of the lists of the groups. Calls visit(key, field, unit, range) for numbers,
/// and visit(key, field) for what has no range.
template <class Parameters, class Visit>
void visitMultirotorParameters(Parameters& parameters, Visit&& visit) {
  visit("law", parameters.law);
  visit("odometry_frame", parameters.odometry_frame);
  visit("use_rc_teleop", parameters.use_rc_teleop);
  visit("provenance", parameters.provenance);
  for (std::size_t i = 0; i < lawTypes().size(); ++i) {
    if (lawTypes()[i].maps != nullptr) visitAxisPaths(lawTypes()[i].maps, parameters.maps[i], visit);
  }
  visitAxisPaths("problems", parameters.problems, visit);
  visitOptions(parameters.controller, visit);
  visitNodeOptions(parameters.node, visit);
  visitLinearTuning(parameters.linear, visit);
  visitNonlinearOptions(parameters.nonlinear, visit);
  visitMomentModel(parameters.moments, visit);
  visitFlightOptions(parameters.flight, visit);
  visitJoyLayout(parameters.joy, visit);
  visitOutputOptions(parameters.output, visit);
}

/// Options of earlier versions.
const std::vector<RemovedOption>& removedOptions();

/// Throws Error where parameters contradict each other, or the thrust curve cannot be flown.
void checkTogether(const MultirotorParameters& parameters);

/// The parameters in a YAML file, by the rules of the node. Throws Error naming file, field and rule where the node
/// would not start with them. It checks keys, types, ranges, limits that contradict each other, and the thrust curve.
/// Maps and problem files are not read.
MultirotorParameters parseMultirotorParameters(const std::string& text, const std::string& source);

}  // namespace polyfly
