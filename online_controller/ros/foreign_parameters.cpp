#include "online_controller_ros/foreign_parameters.hpp"

#include <array>
#include <map>
#include <vector>

#include "online_controller/options.hpp"

namespace polyfly_ros {
namespace {

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

// One weight serves roll and pitch.
constexpr Pair kNonlinear[] = {
    {"q_x", "nonlinear/position_weight_x"},  {"q_y", "nonlinear/position_weight_y"},
    {"q_z", "nonlinear/position_weight_z"},  {"q_vx", "nonlinear/velocity_weight_x"},
    {"q_vy", "nonlinear/velocity_weight_y"}, {"q_vz", "nonlinear/velocity_weight_z"},
    {"q_roll", "nonlinear/attitude_weight"}, {"r_roll", "nonlinear/command_weight"},
    {"r_thrust", "nonlinear/thrust_weight"}, {"prediction_sampling_time", "nonlinear/period"},
};

class Adoption {
 public:
  explicit Adoption(const ros::NodeHandle& handle) : handle_(handle) {}

  /// Whether theirs is a number that counts; ours is set then, unless it was.
  bool number(const std::string& theirs, const std::string& ours, double sign = 1.0, double offset = 0.0) {
    double value = 0.0;
    if (!handle_.getParam(theirs, value)) return false;
    set(theirs, ours, sign * value + offset);
    return true;
  }

  void flag(const std::string& theirs, const std::string& ours) {
    bool value = false;
    if (handle_.getParam(theirs, value)) set(theirs, ours, value);
  }

  void vector(const std::string& theirs, const std::array<const char*, 3>& ours) {
    std::vector<double> values;
    if (!handle_.getParam(theirs, values) || values.size() != ours.size()) return;
    for (std::size_t i = 0; i < ours.size(); ++i) set(theirs, ours[i], values[i]);
  }

  template <class Pairs>
  void numbers(const Pairs& pairs) {
    for (const Pair& pair : pairs) number(pair.theirs, pair.ours);
  }

  const std::string& text() const noexcept { return text_; }

 private:
  template <class Value>
  void set(const std::string& theirs, const std::string& ours, const Value& value) {
    if (handle_.hasParam(ours)) return;
    handle_.setParam(ours, value);
    text_ += (text_.empty() ? "" : ", ") + theirs + " -> " + ours;
  }

  ros::NodeHandle handle_;
  std::string text_;
};

}  // namespace

std::string adoptForeignParameters(const ros::NodeHandle& private_handle, const std::string& law) {
  Adoption adoption(private_handle);
  if (!private_handle.hasParam("law")) private_handle.setParam("law", law);
  adoption.numbers(kVehicle);
  const std::array<const char*, 3> drag{"nonlinear/drag_x", "nonlinear/drag_y", "nonlinear/drag_z"};
  adoption.vector("drag_coefficients", drag);
  adoption.vector("linear_drag_coefficients", drag);
  adoption.flag("enable_offset_free", "controller/offset_free");
  adoption.flag("enable_integrator", "controller/integrator");
  // It sends nothing before a flight begins.
  if (!private_handle.hasParam("control_interface/idle_publishes"))
    private_handle.setParam("control_interface/idle_publishes", false);

  // The greater of the two limits what is sent; the linear law keeps each of them in its problem.
  double roll_max = 0.0, pitch_max = 0.0;
  if (private_handle.getParam("roll_max", roll_max) && private_handle.getParam("pitch_max", pitch_max))
    adoption.number(roll_max > pitch_max ? "roll_max" : "pitch_max", "controller/angle_max");
  if (law == "linear") {
    const double gravity = private_handle.param("vehicle/gravity", polyfly::MultirotorOptions{}.gravity);
    adoption.numbers(kLinear);
    adoption.number("roll_max", "linear/roll_command_min", -1.0);
    adoption.number("pitch_max", "linear/pitch_command_min", -1.0);
    adoption.number("thrust_min", "linear/thrust_command_min", 1.0, -gravity);
    adoption.number("thrust_max", "linear/thrust_command_max", 1.0, -gravity);
  } else {
    adoption.numbers(kNonlinear);
  }
  return adoption.text();
}

}  // namespace polyfly_ros
