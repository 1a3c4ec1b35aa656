#include "online_controller_ros/legacy_parameters.hpp"

#include <ros/param.h>

#include <array>
#include <iterator>
#include <set>
#include <vector>

#include "online_controller/types/options.hpp"
#include "polyfly_base/error.hpp"

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

constexpr Pair kFlags[] = {
    {"enable_offset_free", "controller/offset_free"},
    {"enable_integrator", "controller/integrator"},
};

constexpr Pair kNonlinear[] = {
    {"q_x", "nonlinear/position_weight_x"},      {"q_y", "nonlinear/position_weight_y"},
    {"q_z", "nonlinear/position_weight_z"},      {"q_vx", "nonlinear/velocity_weight_x"},
    {"q_vy", "nonlinear/velocity_weight_y"},     {"q_vz", "nonlinear/velocity_weight_z"},
    {"q_roll", "nonlinear/roll_weight"},         {"q_pitch", "nonlinear/pitch_weight"},
    {"r_roll", "nonlinear/roll_command_weight"}, {"r_pitch", "nonlinear/pitch_command_weight"},
    {"r_thrust", "nonlinear/thrust_weight"},     {"prediction_sampling_time", "nonlinear/period"},
};

/// Every number of theirs that is one of ours.
LegacyNames namesOf(const std::string& law, double gravity) {
  LegacyNames names;
  const auto add = [&](const auto& pairs) {
    for (const Pair& pair : pairs) names.push_back({pair.theirs, pair.ours});
  };
  add(kVehicle);
  names.push_back({"KF_observer/q_force", "controller/disturbance_drift", 1.0, 0.0, false, true});
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

constexpr const char* kImported = "adopted/";  // below it stands what ours were set to

class LegacyImport {
 public:
  explicit LegacyImport(const ros::NodeHandle& handle) : handle_(handle) {}

  /// Where theirs is a number that counts, ours is set, unless it was.
  void number(const LegacyName& name) {
    double value = 0.0;
    if (read(name.theirs, value, "a number")) set(name.theirs, name.ours, name.toOurs(value));
  }

  void flag(const std::string& theirs, const std::string& ours) {
    bool value = false;
    if (read(theirs, value, "true or false")) set(theirs, ours, value);
  }

  void vector(const std::string& theirs, const std::array<const char*, 3>& ours) {
    std::vector<double> values;
    if (!read(theirs, values, "a list of three numbers")) return;
    if (values.size() != ours.size()) refuse(theirs, "a list of three numbers");
    for (std::size_t i = 0; i < ours.size(); ++i) set(theirs, ours[i], values[i]);
  }

  const std::string& text() const noexcept { return text_; }
  bool took(const std::string& theirs) const { return taken_.count(theirs) != 0; }

 private:
  [[noreturn]] void refuse(const std::string& theirs, const char* what) const {
    throw polyfly::Error("parameter " + handle_.resolveName(theirs) + ": must be " + what);
  }

  template <class Value>
  bool read(const std::string& theirs, Value& value, const char* what) const {
    if (!handle_.hasParam(theirs)) return false;
    if (!handle_.getParam(theirs, value)) refuse(theirs, what);
    return true;
  }

  /// Ours stays where somebody set it. Where an earlier start set it from theirs, it stays only as long as
  /// theirs is what it was: the parameter server outlives the node, and a mass changed in a YAML file must
  /// count.
  template <class Value>
  void set(const std::string& theirs, const std::string& ours, const Value& value) {
    taken_.insert(theirs);
    if (!settled_.insert(ours).second) return;
    if (handle_.hasParam(ours)) {
      Value imported{};
      if (!handle_.getParam(kImported + ours, imported) || imported == value) return;
    }
    handle_.setParam(ours, value);
    handle_.setParam(kImported + ours, value);
    text_ += (text_.empty() ? "" : ", ") + theirs + " -> " + ours;
  }

  ros::NodeHandle handle_;
  std::string text_;
  std::set<std::string> taken_;
  std::set<std::string> settled_;
};

/// What of theirs stands there and was not taken, each reason once, in the order of the table.
std::vector<std::string> unread(const ros::NodeHandle& handle, const LegacyImport& importer) {
  std::vector<std::string> names;
  ros::param::getParamNames(names);
  const std::string space = handle.getNamespace() + "/";
  std::vector<std::string> said;
  std::string reason;
  for (const Unread& entry : kUnread) {
    for (const std::string& name : names) {
      if (name.compare(0, space.size(), space) != 0) continue;
      const std::string theirs = name.substr(space.size());
      if (!fits(theirs, entry.theirs) || importer.took(theirs)) continue;
      if (reason == entry.why) {
        said.back().insert(said.back().find(':'), ", " + theirs);
      } else {
        said.push_back(theirs + ": " + entry.why);
        reason = entry.why;
      }
    }
  }
  return said;
}

}  // namespace

LegacyParameters importLegacyParameters(const ros::NodeHandle& private_handle, const std::string& law) {
  LegacyParameters result;
  LegacyImport importer(private_handle);
  if (!private_handle.hasParam("law")) private_handle.setParam("law", law);
  // The greater of the two limits what is sent; the linear law keeps each of them in its problem.
  double roll_max = 0.0, pitch_max = 0.0;  // no numbers are refused below
  if (private_handle.getParam("roll_max", roll_max) && private_handle.getParam("pitch_max", pitch_max))
    importer.number({roll_max > pitch_max ? "roll_max" : "pitch_max", "controller/angle_max"});
  const double gravity = private_handle.param("vehicle/gravity", polyfly::MultirotorOptions{}.gravity);
  result.names = namesOf(law, gravity);
  for (const LegacyName& name : result.names) importer.number(name);
  const std::array<const char*, 3> drag{"nonlinear/drag_x", "nonlinear/drag_y", "nonlinear/drag_z"};
  importer.vector("drag_coefficients", drag);
  importer.vector("linear_drag_coefficients", drag);
  for (const Pair& pair : kFlags) {
    importer.flag(pair.theirs, pair.ours);
    result.names.push_back({pair.theirs, pair.ours});
  }
  if (law != "linear") {
    // To be changed in flight: one limit.
    result.names.push_back({"roll_max", "controller/angle_max"});
    result.names.push_back({"pitch_max", "controller/angle_max"});
  }
  result.taken = importer.text();
  result.unread = unread(private_handle, importer);
  return result;
}

}  // namespace polyfly_ros
