#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "identification/identify_axis.hpp"
#include "identification/motion.hpp"
#include "online_controller/types/attitude.hpp"
#include "polyfly_test/pi_controller.hpp"
#include "polyfly_test/rigid_body_plant.hpp"

namespace polyfly {

/// What `calibrate` sees of a minute of steps to and fro by the PI controller.
inline FlightSignals stepsToIdentify(const RigidBodyOptions& options) {
  RigidBodyPlant plant(options, Eigen::Vector3d::Zero());
  PiController pi{MultirotorOptions{}};
  FlightSignals log;
  log.source = "steps to and fro";
  while (plant.time() < 60.0) {
    const VehicleState state = plant.measure();
    Reference goal;
    goal.position = {std::fmod(state.stamp, 7.0) < 3.5 ? 4.0 : 0.0,
                     std::fmod(state.stamp, 5.0) < 2.5 ? 3.0 : 0.0, 1.0};
    const AttitudeCommand command = pi.step(state, goal);
    const EulerAngles angles = eulerAngles(state.attitude);
    const std::pair<const char*, double> values[] = {{"roll_cmd", command.roll}, {"pitch_cmd", command.pitch},
                                                     {"roll", angles.roll},      {"pitch", angles.pitch},
                                                     {"yaw", angles.yaw},        {"vx", state.velocity.x()},
                                                     {"vy", state.velocity.y()}, {"vz", state.velocity.z()}};
    for (const auto& [name, value] : values) {
      log.series[name].time.push_back(state.stamp);
      log.series[name].value.push_back(value);
    }
    plant.advance(command, 0.01);
  }
  return log;
}

inline FittedParameter parameterOf(const std::vector<FittedParameter>& parameters, const std::string& name) {
  for (const FittedParameter& parameter : parameters)
    if (parameter.name == name) return parameter;
  ADD_FAILURE() << "no parameter " << name;
  return {};
}

}  // namespace polyfly
