#include "excitation/flight.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "online_controller/types/attitude.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/range_check.hpp"

namespace polyfly {
namespace {

// Least speed at which the course of a wing is meaningful [m/s].
constexpr double kLeastSpeed = 1.0;
// Margin below the attitude limit that is left to the roll overshoot of a wing [rad].
constexpr double kOvershoot = 0.1;

bool finite(const VehicleState& state) {
  return std::isfinite(state.stamp) && state.position.allFinite() && state.velocity.allFinite() &&
         state.attitude.coeffs().allFinite();
}

}  // namespace

const char* nameOf(ExcitationState state) {
  constexpr const char* kNames[] = {"waiting", "running", "done", "aborted", "handed over"};
  return kNames[static_cast<std::size_t>(state)];
}

ExcitationFlight::ExcitationFlight(ExcitationPlan plan, const ExcitationOptions& options)
    : plan_(std::move(plan)), options_(options) {
  visitExcitation(options_, RangeCheck{"excitation"});
  if (!(options_.thrust_min < options_.gravity && options_.gravity < options_.thrust_max)) {
    throw Error(
        "excitation: command/thrust_min and thrust_max: hover thrust per mass, gravity, must lie between");
  }
  if (options_.wing && options_.distance_max <= options_.wing_return) {
    throw Error(
        "excitation: limits/distance_max: of a wing, which flies on, must be above wing/return_distance");
  }
  for (const Manoeuvre& manoeuvre : plan_.manoeuvres) {
    if (options_.wing && manoeuvre.channel != ExcitedChannel::kRoll) {
      throw Error(std::string("excitation: plan: a wing is excited in roll only, not in ") +
                  nameOf(manoeuvre.channel));
    }
  }
}

void ExcitationFlight::begin(const VehicleState& state) {
  home_ = start_ = state.position;
  heading_ = eulerAngles(state.attitude).yaw;
  start_stamp_ = last_stamp_ = state.stamp;
  state_ = ExcitationState::kRunning;
}

// The vehicle is held where it is, but at the height where it began.
void ExcitationFlight::abort(const char* reason, const VehicleState* at) {
  if (state_ == ExcitationState::kAborted || state_ == ExcitationState::kHandedOver) return;
  state_ = ExcitationState::kAborted;
  reason_ = reason;
  running_ = -1;
  if (at != nullptr) home_.head<2>() = at->position.head<2>();
}

const char* ExcitationFlight::brokenLimit(const VehicleState& state) const {
  const EulerAngles angles = eulerAngles(state.attitude);
  if (std::max(std::abs(angles.roll), std::abs(angles.pitch)) > options_.attitude_max) return "attitude";
  if ((state.position - start_).head<2>().norm() > options_.distance_max) return "distance";
  if (std::abs(state.position.z() - start_.z()) > options_.height_max) return "height";
  return nullptr;
}

AttitudeCommand ExcitationFlight::step(const VehicleState& state) noexcept {
  if (!finite(state)) {
    if (state_ == ExcitationState::kRunning) abort("odometry is not finite", nullptr);
    return level();
  }
  if (state_ == ExcitationState::kWaiting) begin(state);
  if (state.stamp < last_stamp_) abort("clock jumped back", &state);
  last_stamp_ = state.stamp;
  if (state_ == ExcitationState::kRunning) {
    const char* broken = brokenLimit(state);
    if (broken != nullptr) abort(broken, &state);
  }
  AttitudeCommand command = options_.wing ? holdWing(state) : holdMultirotor(state);
  if (state_ != ExcitationState::kRunning) return limited(command);

  elapsed_ = state.stamp - start_stamp_;
  const int before = std::exchange(running_, plan_.running(elapsed_));
  if (elapsed_ >= plan_.duration()) state_ = ExcitationState::kDone;
  if (running_ >= 0) {
    const Manoeuvre& manoeuvre = plan_.manoeuvres[static_cast<std::size_t>(running_)];
    if (options_.wing) {
      // A turn back goes on in a manoeuvre, as far as there is bank left for it.
      const double left = std::max(options_.attitude_max - kOvershoot - std::abs(manoeuvre.amplitude), 0.0);
      command.roll = std::clamp(command.roll, -left, left);
    }
    if (running_ != before) frozen_ = command;
    if (manoeuvre.shape == ExcitationShape::kTwoOneOne) {
      command.roll = frozen_.roll;
      command.pitch = options_.wing ? command.pitch : frozen_.pitch;
    }
    const auto deviation = plan_.at(elapsed_);
    command.roll += deviation[0];
    command.pitch += deviation[1];
    command.yaw_rate += deviation[2];
    command.thrust += options_.wing ? 0.0 : options_.mass * deviation[3];
  }
  return limited(command);
}

AttitudeCommand ExcitationFlight::limited(AttitudeCommand command) const {
  command.roll = std::clamp(command.roll, -options_.command_max, options_.command_max);
  command.pitch = std::clamp(command.pitch, -options_.command_max, options_.command_max);
  if (!options_.wing) {
    command.thrust =
        std::clamp(command.thrust, options_.mass * options_.thrust_min, options_.mass * options_.thrust_max);
  }
  return command;
}

AttitudeCommand ExcitationFlight::level() const {
  AttitudeCommand command;
  command.pitch = options_.wing ? options_.wing_pitch : 0.0;
  command.thrust = options_.wing ? options_.wing_thrust : options_.mass * options_.gravity;
  return command;
}

// Critically damped; accelerations of the world turned into tilt along the heading.
AttitudeCommand ExcitationFlight::holdMultirotor(const VehicleState& state) const {
  const EulerAngles angles = eulerAngles(state.attitude);
  const auto pull = [&](double frequency, Eigen::Index axis) {
    return frequency * frequency * (home_[axis] - state.position[axis]) -
           2.0 * frequency * state.velocity[axis];
  };
  const double ax = pull(options_.hold_frequency, 0);
  const double ay = pull(options_.hold_frequency, 1);
  const double cosine = std::cos(angles.yaw);
  const double sine = std::sin(angles.yaw);
  AttitudeCommand command;
  command.pitch =
      std::clamp((cosine * ax + sine * ay) / options_.gravity, -options_.tilt_max, options_.tilt_max);
  command.roll =
      std::clamp((sine * ax - cosine * ay) / options_.gravity, -options_.tilt_max, options_.tilt_max);
  command.yaw_rate = std::clamp(options_.yaw_gain * wrapAngle(heading_ - angles.yaw), -options_.yaw_rate_max,
                                options_.yaw_rate_max);
  command.thrust = options_.mass * (options_.gravity + pull(options_.height_frequency, 2)) /
                   tiltCosine({angles.roll, angles.pitch});
  return command;
}

// Straight on near the start, else a turn towards it; in ENU and with roll to the right, a turn to the right
// lessens the course.
AttitudeCommand ExcitationFlight::holdWing(const VehicleState& state) const {
  AttitudeCommand command = level();
  const Eigen::Vector2d way = (home_ - state.position).head<2>();
  const Eigen::Vector2d velocity = state.velocity.head<2>();
  if (way.norm() > options_.wing_return && velocity.norm() > kLeastSpeed) {
    const double error = wrapAngle(std::atan2(way.y(), way.x()) - std::atan2(velocity.y(), velocity.x()));
    command.roll = std::clamp(-error, -options_.wing_roll, options_.wing_roll);
  }
  // Pitch as pilots count it, nose up positive.
  const double climb = options_.wing_height_gain * (home_.z() - state.position.z()) -
                       options_.wing_climb_gain * state.velocity.z();
  command.pitch = std::clamp(options_.wing_pitch + climb, -options_.wing_pitch_max, options_.wing_pitch_max);
  return command;
}

bool ExcitationFlight::onSilence(double time, AttitudeCommand* command) noexcept {
  if (state_ == ExcitationState::kWaiting || !(time - last_stamp_ > options_.silence_max)) return false;
  abort("odometry is silent", nullptr);
  *command = level();
  return commands();
}

void ExcitationFlight::handOver(const char* reason) noexcept {
  reason_ = reason;
  running_ = -1;
  state_ = ExcitationState::kHandedOver;
}

void ExcitationFlight::onSticks(const std::vector<float>& axes) {
  if (sticks_.empty()) {
    sticks_ = axes;
    return;
  }
  for (std::size_t axis = 0; axis < std::max(axes.size(), sticks_.size()); ++axis) {
    // Another number of axes and NaN count as movement.
    const bool same = axis < std::min(axes.size(), sticks_.size());
    if (same && std::abs(axes[axis] - sticks_[axis]) <= options_.stick_max) continue;
    handOver("a stick was moved");
    return;
  }
}

}  // namespace polyfly
