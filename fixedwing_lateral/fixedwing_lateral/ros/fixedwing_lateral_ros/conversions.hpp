#pragma once

#include <fixedwing_lateral/LateralStatus.h>
#include <fixedwing_lateral/Mission.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <mavros_msgs/AttitudeTarget.h>
#include <nav_msgs/Odometry.h>
#include <visualization_msgs/MarkerArray.h>

#include "fixedwing_lateral/guidance.hpp"
#include "fixedwing_lateral/lateral_parameters.hpp"
#include "fixedwing_lateral/turn_limits.hpp"

// The only place where messages become values and frames change: the world from east-north-up to
// north-east-down, the body from forward-left-up to forward-right-down. Roll about the forward axis is the
// same in both.
namespace polyfly_ros {

/// (east, north) to (north, east), and back.
Eigen::Vector2d swapAxes(double x, double y) noexcept;

/// An angle counted anticlockwise from east, counted clockwise from north; and back.
double swapAngle(double angle) noexcept;

/// Pose in the world, twist in the body (the child frame). A quaternion that is not finite or far from unit
/// length gives NaN, which the guidance refuses. The roll rate is the twist's.
polyfly::AircraftState toAircraftState(const nav_msgs::Odometry& message) noexcept;

/// The wind's velocity in the world: where the air moves to, as mavros has it.
polyfly::StampedWind toWind(const geometry_msgs::TwistWithCovarianceStamped& message) noexcept;

/// By the plan for tight turns. Throws polyfly::Error naming segment or waypoint and rule. The message must
/// not be empty.
polyfly::Mission toMission(const fixedwing_lateral::Mission& message, const polyfly::LoiterOptions& loiter,
                           const polyfly::TurnPlan& turns = {});

/// What toMission makes the same mission of; waypoints have become segments. Throws polyfly::Error on a curve
/// that messages have no form for.
fixedwing_lateral::Mission toMessage(const polyfly::Mission& mission);

bool isEmpty(const fixedwing_lateral::Mission& message) noexcept;

/// The roll reference as angular.x; the caller sets the header.
void fillTwist(double roll_reference, geometry_msgs::TwistStamped& message) noexcept;

/// Roll and pitch [rad] at the present heading, rates ignored; thrust in [0, 1], ignored when negative.
using polyfly::AttitudeOptions;
void fillAttitude(double roll_reference, double heading, const AttitudeOptions& options,
                  mavros_msgs::AttitudeTarget& message) noexcept;

/// All but header and times.
void fillStatus(const polyfly::GuidanceOutput& output, fixedwing_lateral::LateralStatus& message);

/// The predicted path, and the mission's segments with the present one standing out.
void fillMarkers(const polyfly::LateralGuidance& guidance, const std_msgs::Header& header, double altitude,
                 visualization_msgs::MarkerArray& message);

}  // namespace polyfly_ros
