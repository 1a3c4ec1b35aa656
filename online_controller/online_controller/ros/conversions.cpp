#include "online_controller_ros/conversions.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "online_controller/types/attitude.hpp"
#include "online_controller/types/remark.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_ros/geometry.hpp"

namespace polyfly_ros {
namespace {

using polyfly::ControlReason;
using polyfly::ControlStatus;
using polyfly::LookupStatus;

template <class Vector>
Eigen::Vector3d toEigen(const Vector& message) {
  return {message.x, message.y, message.z};
}

double toYaw(const geometry_msgs::Quaternion& message, const std::string& place) {
  const Eigen::Quaterniond attitude = toAttitude(message);
  if (std::isnan(attitude.w()))
    throw polyfly::Error(place + "orientation must be a quaternion of unit length");
  return polyfly::eulerAngles(attitude).yaw;
}

polyfly::TrajectorySample toSample(const trajectory_msgs::MultiDOFJointTrajectoryPoint& point,
                                   std::size_t index) {
  const std::string place = "command/trajectory: point " + std::to_string(index) + ": ";
  if (point.transforms.size() != 1 || point.velocities.size() > 1 || point.accelerations.size() > 1) {
    throw polyfly::Error(place + "must have one transform, and at most one velocity and one acceleration");
  }
  polyfly::TrajectorySample sample;
  sample.time = point.time_from_start.toSec();
  sample.position = toEigen(point.transforms[0].translation);
  sample.yaw = toYaw(point.transforms[0].rotation, place);
  sample.has_velocity = !point.velocities.empty();
  if (sample.has_velocity) {
    sample.velocity = toEigen(point.velocities[0].linear);
    sample.yaw_rate = point.velocities[0].angular.z;
  }
  sample.has_acceleration = !point.accelerations.empty();
  if (sample.has_acceleration) sample.acceleration = toEigen(point.accelerations[0].linear);
  return sample;
}

// By ControlStatus and ControlReason.
constexpr std::array<const char*, polyfly::kControlStatusCount> kStatusWords{
    "optimal",
    "clipped",
    "last command repeated",
    "level attitude, hover thrust",
    "no law flies",
    "level attitude, less than hover thrust",
    "nothing is sent",
    "sticks",
    "motors off",
    "suboptimal",
    "least violation",
};
constexpr std::array<const char*, polyfly::kControlReasonCount> kReasonWords{
    "",
    "outside the range of its map",
    "no region holds the parameters",
    "odometry or reference is not finite or absurdly large",
    "odometry is silent or repeats itself",
    "nothing to track yet",
    "the odometry's position or attitude jumped",
    "the odometry's stamp is before the last one",
    "the odometry is in another frame",
    "it does not fly",
    "the remote control has the vehicle",
    "the odometry contradicts itself: flown by the velocity of its positions, or by the attitude of its body "
    "rates",
};

void fillAxis(const polyfly::AxisReport& report, const std::vector<polyfly::Signal>& parameters,
              online_controller::AxisStatus& message) {
  using Message = online_controller::AxisStatus;
  static_assert(
      areCounted({Message::INSIDE, Message::OUTSIDE_BOX, Message::OUTSIDE_PARTITION, Message::NOT_FINITE}),
      "the message restates LookupStatus");
  message.lookup = static_cast<std::uint8_t>(report.lookup);
  message.theta.assign(report.theta.begin(), report.theta.begin() + report.size);
  if (report.outside_parameter >= 0) {
    message.outside_parameter = parameters.at(static_cast<std::size_t>(report.outside_parameter)).name;
  }
  message.region = report.region;
  message.input = report.input;
  message.disturbance = report.disturbance;
}

}  // namespace

polyfly::VehicleState toVehicleState(const nav_msgs::Odometry& message) {
  polyfly::VehicleState state;
  state.stamp = message.header.stamp.toSec();
  state.position = toEigen(message.pose.pose.position);
  state.attitude = toAttitude(message.pose.pose.orientation);
  state.velocity = state.attitude * toEigen(message.twist.twist.linear);
  state.angular_velocity = toEigen(message.twist.twist.angular);
  return state;
}

polyfly::ReferenceTrajectory toReferenceTrajectory(const trajectory_msgs::MultiDOFJointTrajectory& message) {
  std::vector<polyfly::TrajectorySample> samples;
  samples.reserve(message.points.size());
  for (std::size_t i = 0; i < message.points.size(); ++i) samples.push_back(toSample(message.points[i], i));
  try {
    return polyfly::ReferenceTrajectory(std::move(samples));
  } catch (const polyfly::Error& error) {
    throw polyfly::Error(std::string("command/trajectory: ") + error.what());
  }
}

std::optional<double> startOf(const trajectory_msgs::MultiDOFJointTrajectory& message) {
  if (message.header.stamp.isZero()) return std::nullopt;
  return message.header.stamp.toSec();
}

polyfly::ReferenceTrajectory toReferenceTrajectory(const geometry_msgs::PoseStamped& message) {
  const double yaw = toYaw(message.pose.orientation, "command/pose: ");
  try {
    return polyfly::ReferenceTrajectory::pose(toEigen(message.pose.position), yaw);
  } catch (const polyfly::Error& error) {
    throw polyfly::Error(std::string("command/pose: ") + error.what());
  }
}

void fillCommand(const polyfly::AttitudeCommand& command, mav_msgs::RollPitchYawrateThrust& message) {
  message.roll = command.roll;
  message.pitch = command.pitch;
  message.yaw_rate = command.yaw_rate;
  message.thrust.x = 0.0;
  message.thrust.y = 0.0;
  message.thrust.z = command.thrust;
}

void fillAttitudeTarget(const polyfly::AttitudeCommand& command, double yaw,
                        const polyfly::ThrustCurve& curve, mavros_msgs::AttitudeTarget& message) {
  using mavros_msgs::AttitudeTarget;
  const Eigen::Quaterniond attitude = polyfly::attitudeOf({command.roll, command.pitch, yaw});
  message.type_mask = AttitudeTarget::IGNORE_ROLL_RATE | AttitudeTarget::IGNORE_PITCH_RATE;
  message.orientation.w = attitude.w();
  message.orientation.x = attitude.x();
  message.orientation.y = attitude.y();
  message.orientation.z = attitude.z();
  message.body_rate.x = 0.0;
  message.body_rate.y = 0.0;
  message.body_rate.z = command.yaw_rate;
  message.thrust = static_cast<float>(curve(command.thrust));
}

double yawOf(const polyfly::VehicleState& state) {
  return state.attitude.coeffs().allFinite() ? polyfly::eulerAngles(state.attitude).yaw
                                             : std::numeric_limits<double>::quiet_NaN();
}

void fillStatus(const polyfly::ControlReport& report,
                const std::array<std::vector<polyfly::Signal>, 3>& parameters,
                online_controller::ControllerStatus& message) {
  using Message = online_controller::ControllerStatus;
  static_assert(areCounted({Message::OPTIMAL, Message::CLIPPED, Message::HOLD_LAST, Message::LEVEL,
                            Message::NO_REFERENCE, Message::DESCEND, Message::STOPPED, Message::MANUAL,
                            Message::MOTORS_OFF, Message::SUBOPTIMAL, Message::LEAST_VIOLATION}),
                "the message restates ControlStatus");
  static_assert(
      areCounted({Message::REASON_NONE, Message::REASON_OUTSIDE_BOX, Message::REASON_OUTSIDE_PARTITION,
                  Message::REASON_NOT_FINITE, Message::REASON_STALE, Message::REASON_NO_REFERENCE,
                  Message::REASON_JUMP, Message::REASON_OUT_OF_ORDER, Message::REASON_WRONG_FRAME,
                  Message::REASON_ON_GROUND, Message::REASON_PILOT}),
      "the message restates ControlReason up to kPilot");
  message.status = static_cast<std::uint8_t>(report.status);
  message.reason = static_cast<std::uint8_t>(report.reason);
  message.text = describe(report, &parameters);
  fillAxis(report.axis[0], parameters[0], message.longitudinal);
  fillAxis(report.axis[1], parameters[1], message.lateral);
  fillAxis(report.axis[2], parameters[2], message.vertical);
  message.roll_trim = report.trim.roll;
  message.pitch_trim = report.trim.pitch;
  message.attitude_coupling = report.coupling;
}

const char* words(ControlStatus status) { return kStatusWords.at(static_cast<std::size_t>(status)); }

bool isAsAsked(const polyfly::ControlReport& report) noexcept {
  return (report.status == ControlStatus::kOptimal && !polyfly::isOutsideMap(report) &&
          !polyfly::hasRemark(report)) ||
         report.reason == ControlReason::kOnGround || report.reason == ControlReason::kPilot;
}

std::string describe(const polyfly::ControlReport& report,
                     const std::array<std::vector<polyfly::Signal>, 3>* parameters) {
  std::string text = words(report.status);
  if (report.reason != ControlReason::kNone) text += ": ";
  if (report.reason == ControlReason::kOutsideBox && parameters != nullptr) {
    std::string names;
    for (std::size_t i = 0; i < report.axis.size(); ++i) {
      const int outside = report.axis[i].outside_parameter;
      if (outside >= 0)
        names += (names.empty() ? "" : ", ") + (*parameters)[i].at(static_cast<std::size_t>(outside)).name;
    }
    text += names + " ";
  }
  text += kReasonWords.at(static_cast<std::size_t>(report.reason));
  return polyfly::hasRemark(report) ? text + "; " + polyfly::remarkOn(report) : text;
}

}  // namespace polyfly_ros
