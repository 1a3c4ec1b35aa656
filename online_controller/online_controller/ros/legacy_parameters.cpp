#include "online_controller_ros/legacy_parameters.hpp"

#include <iterator>

namespace polyfly_ros {
namespace {

/// Why something of theirs is not read; `theirs` may end in a star.
struct Unread {
  const char* theirs;
  const char* why;
};

constexpr const char* kSteady =
    "the observers have the gains of the steady state from the first sample on, which depend on q_* and r_* "
    "alone";
constexpr const char* kUnlimited = "the published estimate is not limited";

constexpr Unread kUnread[] = {
    {"KF_observer/P0_*", kSteady},
    {"KF_observer/omega_limit", kUnlimited},
    {"KF_observer/external_forces_limit", kUnlimited},
    {"KF_observer/external_moments_limit", kUnlimited},
    {"KF_observer/drag_coefficients", "the observer has the drag of the model, nonlinear/drag_x .. z"},
    {"KF_observer/yaw_damping", "the loop of the yaw rate is of first order, with yaw_omega"},
    {"prediction_sampling_time", "the linear law predicts in the sampling_time of its problems, 0.1 s"},
    {"reference_frame", "frames are those of the messages; odometry_frame demands one"},
    {"verbose", "what is logged is chosen by rosconsole's levels"},
};

bool fits(const std::string& name, const std::string& pattern) {
  if (pattern.back() != '*') return name == pattern;
  return name.compare(0, pattern.size() - 1, pattern, 0, pattern.size() - 1) == 0;
}

struct Pair {
  const char* theirs;
  const char* ours;
};

constexpr Pair kVehicle[] = {
    {"mass", "vehicle/mass"},
    {"roll_time_constant", "nonlinear/roll_time"},
    {"pitch_time_constant", "nonlinear/pitch_time"},
    {"roll_gain", "nonlinear/roll_gain"},
    {"pitch_gain", "nonlinear/pitch_gain"},
    {"yaw_rate_max", "controller/yaw_rate_max"},
    {"thrust_min", "controller/thrust_min"},
    {"thrust_max", "controller/thrust_max"},
    {"K_yaw", "controller/yaw_gain"},
    {"sampling_time", "controller/control_period"},
    {"Ki_xy", "controller/integral_gain_xy"},
    {"Ki_altitude", "controller/integral_gain_z"},
    {"Ki_z", "controller/integral_gain_z"},
    {"position_error_integration_limit", "controller/integral_limit"},
    {"antiwindup_ball", "controller/antiwindup_ball"},
    {"enable_offset_free", "controller/offset_free"},
    {"enable_integrator", "controller/integrator"},
};

constexpr Pair kLinear[] = {
    {"q_x", "linear/position_weight_x"},
    {"q_y", "linear/position_weight_y"},
    {"q_z", "linear/position_weight_z"},
    {"q_vx", "linear/velocity_weight_x"},
    {"q_vy", "linear/velocity_weight_y"},
    {"q_vz", "linear/velocity_weight_z"},
    {"q_roll", "linear/roll_weight"},
    {"q_pitch", "linear/pitch_weight"},
    {"r_roll", "linear/roll_command_weight"},
    {"r_pitch", "linear/pitch_command_weight"},
    {"r_thrust", "linear/thrust_command_weight"},
    {"r_droll", "linear/roll_rate_weight"},
    {"r_dpitch", "linear/pitch_rate_weight"},
    {"r_dthrust", "linear/thrust_rate_weight"},
    {"roll_max", "linear/roll_command_max"},
    {"pitch_max", "linear/pitch_command_max"},
};

// Those that are not the same number.
const LegacyName kLinearLimits[] = {
    {"roll_max", "linear/roll_command_min", -1.0},
    {"pitch_max", "linear/pitch_command_min", -1.0},
    {"roll_max", "controller/angle_max", 1.0, 0.0, true},
    {"pitch_max", "controller/angle_max", 1.0, 0.0, true},
};

constexpr Pair kNonlinear[] = {
    {"q_x", "nonlinear/position_weight_x"},      {"q_y", "nonlinear/position_weight_y"},
    {"q_z", "nonlinear/position_weight_z"},      {"q_vx", "nonlinear/velocity_weight_x"},
    {"q_vy", "nonlinear/velocity_weight_y"},     {"q_vz", "nonlinear/velocity_weight_z"},
    {"q_roll", "nonlinear/roll_weight"},         {"q_pitch", "nonlinear/pitch_weight"},
    {"r_roll", "nonlinear/roll_command_weight"}, {"r_pitch", "nonlinear/pitch_command_weight"},
    {"r_thrust", "nonlinear/thrust_weight"},     {"prediction_sampling_time", "nonlinear/period"},
    {"roll_max", "controller/angle_max"},        {"pitch_max", "controller/angle_max"},
};

}  // namespace

LegacyNames legacyNames(const std::string& law, double gravity) {
  LegacyNames names;
  const auto add = [&](const auto& pairs) {
    for (const Pair& pair : pairs) names.push_back({pair.theirs, pair.ours});
  };
  add(kVehicle);
  names.push_back({"KF_observer/q_force", "controller/disturbance_drift", 1.0, 0.0, false, true});
  for (const char* theirs : {"drag_coefficients", "linear_drag_coefficients"}) {
    int element = 0;
    for (const char* ours : {"nonlinear/drag_x", "nonlinear/drag_y", "nonlinear/drag_z"})
      names.push_back({theirs, ours, 1.0, 0.0, false, false, element++});
  }
  if (law != "linear") {
    add(kNonlinear);
    return names;
  }
  add(kLinear);
  names.insert(names.end(), std::begin(kLinearLimits), std::end(kLinearLimits));
  names.push_back({"thrust_min", "linear/thrust_command_min", 1.0, -gravity});
  names.push_back({"thrust_max", "linear/thrust_command_max", 1.0, -gravity});
  return names;
}

const char* whyUnread(const std::string& theirs) {
  for (const Unread& entry : kUnread) {
    if (fits(theirs, entry.theirs)) return entry.why;
  }
  return nullptr;
}

}  // namespace polyfly_ros
