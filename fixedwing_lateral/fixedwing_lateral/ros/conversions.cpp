#include "fixedwing_lateral_ros/conversions.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "fixedwing_lateral/spline_path.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_ros/geometry.hpp"

namespace polyfly_ros {
namespace {

using fixedwing_lateral::LateralStatus;
using polyfly::GuidanceMode;
using polyfly::GuidanceReason;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

double yawOf(const Eigen::Quaterniond& q) noexcept {
  return std::atan2(2.0 * (q.w() * q.z() + q.x() * q.y()), 1.0 - 2.0 * (q.y() * q.y() + q.z() * q.z()));
}

double rollOf(const Eigen::Quaterniond& q) noexcept {
  return std::atan2(2.0 * (q.w() * q.x() + q.y() * q.z()), 1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y()));
}

polyfly::TurnDirection toDirection(int direction, const std::string& where) {
  if (direction == 1) return polyfly::TurnDirection::kRight;
  if (direction == -1) return polyfly::TurnDirection::kLeft;
  throw polyfly::Error(where + ": direction: must be 1 (right) or -1 (left), got " +
                       std::to_string(direction));
}

polyfly::PathSegment toSpline(const fixedwing_lateral::PathSegment& message, const std::string& where,
                              std::vector<std::shared_ptr<const polyfly::PathCurve>>& curves) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(message.points.size());
  for (const geometry_msgs::Point& point : message.points) points.push_back(swapAxes(point.x, point.y));
  curves.push_back(std::make_shared<polyfly::SplinePath>(points, where));
  return polyfly::CurveSegment{curves.back().get()};
}

/// A curve goes to `curves` and must live as long as the segment.
polyfly::PathSegment toSegment(const fixedwing_lateral::PathSegment& message, const std::string& where,
                               std::vector<std::shared_ptr<const polyfly::PathCurve>>& curves) {
  const Eigen::Vector2d a = swapAxes(message.a.x, message.a.y);
  switch (message.type) {
    case fixedwing_lateral::PathSegment::LINE:
      return polyfly::LineSegment{a, swapAxes(message.b.x, message.b.y)};
    case fixedwing_lateral::PathSegment::ARC:
      return polyfly::ArcSegment{a, message.radius, toDirection(message.direction, where),
                                 message.start_bearing, message.sweep};
    case fixedwing_lateral::PathSegment::LOITER:
      return polyfly::LoiterCircle{a, message.radius, toDirection(message.direction, where)};
    case fixedwing_lateral::PathSegment::SPLINE:
      return toSpline(message, where, curves);
    default:
      throw polyfly::Error(where + ": type: must be 0 (line), 1 (arc), 2 (loiter) or 3 (spline), got " +
                           std::to_string(message.type));
  }
}

geometry_msgs::Point toPoint(const Eigen::Vector2d& place, double altitude) {
  geometry_msgs::Point point;
  point.x = place.y();
  point.y = place.x();
  point.z = altitude;
  return point;
}

std::int8_t fromDirection(polyfly::TurnDirection direction) noexcept {
  return direction == polyfly::TurnDirection::kRight ? 1 : -1;
}

fixedwing_lateral::PathSegment fromSegment(const polyfly::PathSegment& segment) {
  fixedwing_lateral::PathSegment message;
  if (const auto* line = std::get_if<polyfly::LineSegment>(&segment)) {
    message.type = fixedwing_lateral::PathSegment::LINE;
    message.a = toPoint(line->a, 0.0);
    message.b = toPoint(line->b, 0.0);
  } else if (const auto* arc = std::get_if<polyfly::ArcSegment>(&segment)) {
    message.type = fixedwing_lateral::PathSegment::ARC;
    message.a = toPoint(arc->centre, 0.0);
    message.radius = arc->radius;
    message.direction = fromDirection(arc->direction);
    message.start_bearing = arc->start_bearing;
    message.sweep = arc->sweep;
  } else if (const auto* loiter = std::get_if<polyfly::LoiterCircle>(&segment)) {
    message.type = fixedwing_lateral::PathSegment::LOITER;
    message.a = toPoint(loiter->centre, 0.0);
    message.radius = loiter->radius;
    message.direction = fromDirection(loiter->direction);
  } else {
    const auto* spline =
        dynamic_cast<const polyfly::SplinePath*>(std::get<polyfly::CurveSegment>(segment).curve);
    if (spline == nullptr) throw polyfly::Error("mission: a curve that is no spline has no message");
    message.type = fixedwing_lateral::PathSegment::SPLINE;
    for (const Eigen::Vector2d& point : spline->points()) message.points.push_back(toPoint(point, 0.0));
  }
  return message;
}

void setColour(visualization_msgs::Marker& marker, float red, float green, float blue, float opacity) {
  marker.color.r = red;
  marker.color.g = green;
  marker.color.b = blue;
  marker.color.a = opacity;
}

visualization_msgs::Marker makeLine(const std_msgs::Header& header, const char* name, int id, double width) {
  visualization_msgs::Marker marker;
  marker.header = header;
  marker.ns = name;
  marker.id = id;
  marker.type = visualization_msgs::Marker::LINE_STRIP;
  marker.scale.x = width;
  marker.pose.orientation.w = 1.0;
  return marker;
}

}  // namespace

Eigen::Vector2d swapAxes(double x, double y) noexcept { return {y, x}; }

double swapAngle(double angle) noexcept { return polyfly::wrapCourse(polyfly::kPi / 2.0 - angle); }

polyfly::AircraftState toAircraftState(const nav_msgs::Odometry& message) noexcept {
  const Eigen::Quaterniond attitude = toAttitude(message.pose.pose.orientation);
  const auto& linear = message.twist.twist.linear;
  const Eigen::Vector3d velocity = attitude * Eigen::Vector3d(linear.x, linear.y, linear.z);
  polyfly::AircraftState state;
  state.stamp = message.header.stamp.toSec();
  state.position = swapAxes(message.pose.pose.position.x, message.pose.pose.position.y);
  state.ground_velocity = swapAxes(velocity.x(), velocity.y());
  state.heading = swapAngle(yawOf(attitude));
  state.roll = rollOf(attitude);
  state.roll_rate = message.twist.twist.angular.x;
  return state;
}

polyfly::StampedWind toWind(const geometry_msgs::TwistWithCovarianceStamped& message) noexcept {
  const auto& linear = message.twist.twist.linear;
  return {swapAxes(linear.x, linear.y), message.header.stamp.toSec()};
}

bool isEmpty(const fixedwing_lateral::Mission& message) noexcept {
  return message.segments.empty() && message.waypoints.empty();
}

polyfly::Mission toMission(const fixedwing_lateral::Mission& message, const polyfly::LoiterOptions& loiter,
                           const polyfly::TurnPlan& turns) {
  if (!message.segments.empty() && !message.waypoints.empty())
    throw polyfly::Error("mission: has segments and waypoints; give one of them");
  if (!message.segments.empty()) {
    std::vector<polyfly::PathSegment> segments;
    std::vector<std::shared_ptr<const polyfly::PathCurve>> curves;
    for (std::size_t i = 0; i < message.segments.size(); ++i)
      segments.push_back(toSegment(message.segments[i], "mission: segment " + std::to_string(i), curves));
    polyfly::Mission mission = polyfly::makeMission(std::move(segments), loiter, "mission");
    mission.curves = std::move(curves);
    return polyfly::fitTurns(std::move(mission), turns, "mission");
  }
  if (message.turn_radius == 0.0) {
    std::vector<Eigen::Vector2d> points;
    for (const geometry_msgs::Pose& pose : message.waypoints)
      points.push_back(swapAxes(pose.position.x, pose.position.y));
    return polyfly::fitTurns(polyfly::missionThrough(points, loiter, "mission"), turns, "mission");
  }
  std::vector<polyfly::PathPose> poses;
  for (const geometry_msgs::Pose& pose : message.waypoints)
    poses.push_back(
        {swapAxes(pose.position.x, pose.position.y), swapAngle(yawOf(toAttitude(pose.orientation)))});
  const double radius = message.turn_radius > 0.0 ? turns.planned(message.turn_radius) : message.turn_radius;
  return polyfly::fitTurns(
      polyfly::makeMission(polyfly::planDubins(poses, radius, "mission"), loiter, "mission"), turns,
      "mission");
}

fixedwing_lateral::Mission toMessage(const polyfly::Mission& mission) {
  fixedwing_lateral::Mission message;
  for (const polyfly::PathSegment& segment : mission.segments)
    message.segments.push_back(fromSegment(segment));
  return message;
}

void fillTwist(double roll_reference, geometry_msgs::TwistStamped& message) noexcept {
  message.twist.angular.x = roll_reference;
}

void fillAttitude(double roll_reference, double heading, const AttitudeOptions& options,
                  mavros_msgs::AttitudeTarget& message) noexcept {
  using mavros_msgs::AttitudeTarget;
  // Nose up is a negative rotation about the axis to the left.
  const Eigen::Quaterniond attitude = Eigen::AngleAxisd(swapAngle(heading), Eigen::Vector3d::UnitZ()) *
                                      Eigen::AngleAxisd(-options.pitch, Eigen::Vector3d::UnitY()) *
                                      Eigen::AngleAxisd(roll_reference, Eigen::Vector3d::UnitX());
  message.orientation.w = attitude.w();
  message.orientation.x = attitude.x();
  message.orientation.y = attitude.y();
  message.orientation.z = attitude.z();
  message.type_mask =
      AttitudeTarget::IGNORE_ROLL_RATE | AttitudeTarget::IGNORE_PITCH_RATE | AttitudeTarget::IGNORE_YAW_RATE;
  if (options.thrust < 0.0) message.type_mask |= AttitudeTarget::IGNORE_THRUST;
  message.thrust = static_cast<float>(std::max(options.thrust, 0.0));
}

void fillStatus(const polyfly::GuidanceOutput& output, LateralStatus& message) {
  static_assert(static_cast<int>(GuidanceMode::kFallback) == LateralStatus::FALLBACK, "as in the message");
  static_assert(static_cast<int>(GuidanceReason::kNotConverging) == LateralStatus::REASON_NOT_CONVERGING,
                "as in the message");
  message.mode = static_cast<std::uint8_t>(output.mode);
  message.reason = static_cast<std::uint8_t>(output.reason);
  message.text = std::string(toString(output.mode)) + ": " + toString(output.reason);
  message.roll_reference = output.roll_reference;
  message.segment = output.segment;
  message.segment_count = output.segment_count;
  message.loitering = output.loitering;
  message.track_error = output.error.track;
  message.course_error = output.error.course;
  message.segment_roll = output.segment_roll;
  message.airspeed = output.airspeed;
  message.wind_north = output.wind.x();
  message.wind_east = output.wind.y();
  message.roll_bias = output.roll_bias;
  message.turn_gain = output.turn_gain;
  message.turn_bias = output.turn_bias;
  message.solver_status = static_cast<std::uint8_t>(output.nmpc.status);
  message.kkt = output.nmpc.kkt;
  message.cost = output.nmpc.cost;
  message.active_bounds = output.nmpc.active_bounds;
  message.restarted = output.restarted;
}

void fillMarkers(const polyfly::LateralGuidance& guidance, const std_msgs::Header& header, double altitude,
                 visualization_msgs::MarkerArray& message) {
  constexpr int kPoints = 60;
  // Deletes the markers that a longer mission left.
  visualization_msgs::Marker clear;
  clear.header = header;
  clear.action = visualization_msgs::Marker::DELETEALL;
  message.markers.push_back(clear);
  visualization_msgs::Marker prediction = makeLine(header, "prediction", 0, 3.0);
  setColour(prediction, 1.0F, 0.4F, 0.0F, 1.0F);
  for (int k = 0; k <= guidance.nmpc().horizon(); ++k)
    prediction.points.push_back(toPoint(guidance.nmpc().nodes()[k].head<2>(), altitude));
  message.markers.push_back(prediction);
  const polyfly::MissionTrack& track = guidance.track();
  for (int i = 0; i < track.count(); ++i) {
    const polyfly::PathSegment& segment = track.segments()[i];
    const auto* loiter = std::get_if<polyfly::LoiterCircle>(&segment);
    const double length = loiter != nullptr ? 2.0 * polyfly::kPi * loiter->radius : polyfly::length(segment);
    visualization_msgs::Marker line = makeLine(header, "mission", i, 1.5);
    const bool is_current = i == track.index();
    setColour(line, is_current ? 0.0F : 0.7F, is_current ? 0.9F : 0.7F, is_current ? 0.4F : 0.7F, 1.0F);
    for (int j = 0; j <= kPoints; ++j)
      line.points.push_back(toPoint(polyfly::pointAt(segment, length * j / kPoints).position, altitude));
    message.markers.push_back(line);
  }
}

}  // namespace polyfly_ros
