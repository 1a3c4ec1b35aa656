#include "online_controller/parameters/multirotor_parameters.hpp"

#include "online_controller/types/option_groups.hpp"
#include "online_controller/types/thrust_curve.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/options_from_yaml.hpp"

namespace polyfly {

const std::vector<RemovedOption>& removedOptions() {
  constexpr const char* kByPrefix =
      "start the node, or the nodelet manager, with launch-prefix=\"chrt -f 50 taskset -c 2\"";
  constexpr const char* kByThread = "odometry is answered in the control thread";
  constexpr const char* kTouchdown =
      "a vehicle stands that is 0.3 m above its sinking reference, slower than 0.15 m/s, for 50 control "
      "periods";
  constexpr const char* kFound =
      "trim and coupling are found in flight; give a known trim by vehicle/roll_trim, pitch_trim";
  constexpr const char* kThrust =
      "what is sent lies between 0 and 1; controller/thrust_min and thrust_max limit the force";
  constexpr const char* kPenalty = "the penalty is 1e5";
  constexpr const char* kState =
      "nonlinear/speed_max limits the velocity, controller/angle_max the tilt, and the safety filter the "
      "place";
  static const std::vector<RemovedOption> kRemoved{
      {"control_interface/idle_publishes",
       "nothing is sent before a reference or a take-off; for the set-points that an autopilot "
       "needs to become guided use control_interface/offboard_stream"},
      {"real_time/priority", kByPrefix},
      {"real_time/core", kByPrefix},
      {"real_time/lock_memory", kByPrefix},
      {"real_time/answer", kByThread},
      {"real_time/poll", kByThread},
      {"real_time/rehearse", kByThread},
      {"control_interface/takeoff_tolerance", "a take-off ends within 0.1 m of its height"},
      {"control_interface/touchdown_lag", kTouchdown},
      {"control_interface/touchdown_speed", kTouchdown},
      {"control_interface/touchdown_periods", kTouchdown},
      {"control_interface/brake", "a hold stops with 2 m/s^2"},
      {"controller/descend_thrust", "a descent has 0.95 of the hover thrust"},
      {"controller/jump_angle",
       "a jump of the attitude is one by 1 rad; controller/jump_distance 0 accepts all jumps"},
      {"controller/trim_drift", kFound},
      {"controller/attitude_coupling", kFound},
      {"controller/coupling_drift", kFound},
      {"KF_observer/r_angular_velocity", "the published moments count on a noise of 0.05 rad/s"},
      {"output/thrust_least", kThrust},
      {"output/thrust_greatest", kThrust},
      {"reference_limits/height", "use reference_limits/distance"},
      {"nonlinear/speed_penalty", kPenalty},
      {"nonlinear/position_penalty", kPenalty},
      {"nonlinear/tilt_penalty", kPenalty},
      {"nonlinear/position_max", kState},
      {"nonlinear/height_min", kState},
      {"nonlinear/height_max", kState},
      {"nonlinear/tilt_max", kState}};
  return kRemoved;
}

void checkTogether(const MultirotorParameters& parameters) {
  lawOfName(parameters.law);
  checkOptions(parameters.controller);
  checkOutputOptions(parameters.output);
  const MultirotorOptions& vehicle = parameters.controller;
  if (parameters.output.attitude_target)
    ThrustCurve(parameters.output.thrust, vehicle.mass * vehicle.thrust_min,
                vehicle.mass * vehicle.thrust_max, vehicle.mass * vehicle.gravity);
}

MultirotorParameters parseMultirotorParameters(const std::string& text, const std::string& source) {
  OptionsFromYaml reader(text, source);
  MultirotorParameters parameters;
  visitMultirotorParameters(parameters, reader);
  reader.refuseRemoved(removedOptions());
  reader.refuseUnknownGroups(knownGroups(), {kSingleOptions.begin(), kSingleOptions.end()});
  reader.refuseUnknownKeys(ownGroups());
  try {
    checkTogether(parameters);
  } catch (const Error& error) {
    throw Error(source + ": " + error.what());
  }
  return parameters;
}

}  // namespace polyfly
