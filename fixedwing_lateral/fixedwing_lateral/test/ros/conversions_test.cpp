// Frames: east-north-up and forward-left-up outside, north-east-down and forward-right-down inside.
#include "fixedwing_lateral_ros/conversions.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

#include "fixedwing_lateral/mission_file.hpp"
#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly_ros;
using Eigen::AngleAxisd;
using Eigen::Vector3d;

constexpr double kExact = 1e-12;
constexpr double kPi = polyfly::kPi;

geometry_msgs::Quaternion toMessage(const Eigen::Quaterniond& q) {
  geometry_msgs::Quaternion message;
  message.w = q.w();
  message.x = q.x();
  message.y = q.y();
  message.z = q.z();
  return message;
}

Eigen::Quaterniond fromMessage(const geometry_msgs::Quaternion& q) { return {q.w, q.x, q.y, q.z}; }

/// The attitude of the world NED from the body FRD as one of ENU from FLU: two half turns.
Eigen::Quaterniond enuFromNed(double heading, double pitch, double roll) {
  const Eigen::Quaterniond ned(AngleAxisd(heading, Vector3d::UnitZ()) * AngleAxisd(pitch, Vector3d::UnitY()) *
                               AngleAxisd(roll, Vector3d::UnitX()));
  Eigen::Matrix3d world;
  world << 0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, -1.0;
  const Eigen::Matrix3d body = Vector3d(1.0, -1.0, -1.0).asDiagonal();
  return Eigen::Quaterniond(Eigen::Matrix3d(world * ned.toRotationMatrix() * body));
}

TEST(Conversions, AStateInBothFrames) {
  for (const double heading : {0.0, 1.0, -2.0, 3.1}) {
    for (const double roll : {0.0, 0.5, -0.4}) {
      const double pitch = 0.1;
      nav_msgs::Odometry odometry;
      odometry.header.stamp = ros::Time(12.5);
      odometry.pose.pose.position.x = 30.0;  // east
      odometry.pose.pose.position.y = 40.0;  // north
      const Eigen::Quaterniond attitude = enuFromNed(heading, pitch, roll);
      odometry.pose.pose.orientation = toMessage(attitude);
      const Vector3d velocity_enu(5.0, 12.0, 0.5);
      const Vector3d body = attitude.inverse() * velocity_enu;
      odometry.twist.twist.linear.x = body.x();
      odometry.twist.twist.linear.y = body.y();
      odometry.twist.twist.linear.z = body.z();
      odometry.twist.twist.angular.x = 0.3;
      const polyfly::AircraftState state = toAircraftState(odometry);
      EXPECT_EQ(state.stamp, 12.5);
      EXPECT_EQ(state.position, Eigen::Vector2d(40.0, 30.0));
      EXPECT_NEAR(state.ground_velocity.x(), 12.0, kExact);
      EXPECT_NEAR(state.ground_velocity.y(), 5.0, kExact);
      EXPECT_NEAR(polyfly::wrapCourse(state.heading - heading), 0.0, kExact);
      EXPECT_NEAR(state.roll, roll, kExact);
      EXPECT_EQ(state.roll_rate, 0.3);
    }
  }
}

TEST(Conversions, ACommandInBothFrames) {
  for (const double heading : {0.0, 1.0, -2.0}) {
    mavros_msgs::AttitudeTarget target;
    fillAttitude(0.4, heading, {0.05, 0.6}, target);
    EXPECT_NEAR(fromMessage(target.orientation).angularDistance(enuFromNed(heading, 0.05, 0.4)), 0.0, 1e-7);
    EXPECT_EQ(target.type_mask, 7);
    EXPECT_FLOAT_EQ(target.thrust, 0.6F);
    fillAttitude(0.4, heading, {}, target);
    EXPECT_EQ(target.type_mask, 7 + 64);
    EXPECT_EQ(target.thrust, 0.0F);
  }
  geometry_msgs::TwistStamped twist;
  fillTwist(-0.2, twist);
  EXPECT_EQ(twist.twist.angular.x, -0.2);
}

TEST(Conversions, AQuaternionThatIsNoneIsRefused) {
  nav_msgs::Odometry odometry;  // all zero
  EXPECT_TRUE(std::isnan(toAircraftState(odometry).heading));
  EXPECT_TRUE(std::isnan(toAircraftState(odometry).ground_velocity.x()));
  odometry.pose.pose.orientation.w = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(std::isnan(toAircraftState(odometry).roll));
}

TEST(Conversions, WindIsWhereTheAirMoves) {
  geometry_msgs::TwistWithCovarianceStamped wind;
  wind.header.stamp = ros::Time(3.0);
  // In ROS, x points to the east.
  wind.twist.twist.linear.x = 2.0;
  wind.twist.twist.linear.y = -1.0;
  EXPECT_EQ(toWind(wind).value, Eigen::Vector2d(-1.0, 2.0));
  EXPECT_EQ(toWind(wind).stamp, 3.0);
}

geometry_msgs::Pose poseAt(double east, double north, double yaw) {
  geometry_msgs::Pose pose;
  pose.position.x = east;
  pose.position.y = north;
  pose.orientation = toMessage(Eigen::Quaterniond(AngleAxisd(yaw, Vector3d::UnitZ())));
  return pose;
}

TEST(Conversions, AMissionOfWaypointsLinesAndDubins) {
  fixedwing_lateral::Mission message;
  EXPECT_TRUE(isEmpty(message));
  message.waypoints = {poseAt(0.0, 0.0, kPi / 2.0), poseAt(0.0, 200.0, 0.0), poseAt(300.0, 200.0, 0.0)};
  const polyfly::Mission lines = toMission(message, {});
  ASSERT_EQ(lines.segments.size(), 3U);
  EXPECT_EQ(std::get<polyfly::LineSegment>(lines.segments[0]).b, Eigen::Vector2d(200.0, 0.0));
  message.turn_radius = 50.0;
  const polyfly::Mission dubins = toMission(message, {});
  EXPECT_GT(dubins.segments.size(), 3U);
  const polyfly::PathPoint start = polyfly::pointAt(dubins.segments[0], 0.0);
  EXPECT_NEAR(start.tangent.x(), 1.0, 1e-9);  // yaw of a quarter turn is north
}

TEST(Conversions, AMissionOfSegments) {
  fixedwing_lateral::Mission message;
  message.segments.resize(3);
  message.segments[0].b.y = 100.0;
  message.segments[1].type = fixedwing_lateral::PathSegment::ARC;
  message.segments[1].a.x = 50.0;
  message.segments[1].a.y = 100.0;
  message.segments[1].radius = 50.0;
  message.segments[1].direction = 1;
  message.segments[1].start_bearing = -kPi / 2.0;
  message.segments[1].sweep = 2.0;
  message.segments[2].type = fixedwing_lateral::PathSegment::LOITER;
  message.segments[2].radius = 70.0;
  message.segments[2].direction = -1;
  const polyfly::Mission mission = toMission(message, {});
  ASSERT_EQ(mission.segments.size(), 3U);
  const auto& arc = std::get<polyfly::ArcSegment>(mission.segments[1]);
  EXPECT_EQ(arc.centre, Eigen::Vector2d(100.0, 50.0));
  EXPECT_LT((polyfly::pointAt(arc, 0.0).position - Eigen::Vector2d(100.0, 0.0)).norm(), 1e-9);
  EXPECT_LT((polyfly::pointAt(arc, 0.0).tangent - Eigen::Vector2d(1.0, 0.0)).norm(), 1e-9);
  message.segments[1].direction = 0;
  EXPECT_THROW(toMission(message, {}), polyfly::Error);
  message.segments[1].direction = 1;
  message.segments[1].type = 9;
  EXPECT_THROW(toMission(message, {}), polyfly::Error);
  message.segments[1].type = 1;
  message.waypoints.resize(2);
  EXPECT_THROW(toMission(message, {}), polyfly::Error);
}

TEST(Conversions, MarkersInTheWorldOfTheOdometry) {
  polyfly::LateralGuidance guidance(polyfly::GuidanceOptions{}, "test");
  guidance.setMission(polyfly::missionThrough({{0.0, 0.0}, {200.0, 0.0}}, {}, "test"));
  std_msgs::Header header;
  header.frame_id = "map";
  visualization_msgs::MarkerArray markers;
  fillMarkers(guidance, header, 80.0, markers);
  ASSERT_EQ(markers.markers.size(), 4U);
  EXPECT_EQ(markers.markers[0].action, visualization_msgs::Marker::DELETEALL);
  EXPECT_EQ(markers.markers[1].points.size(), 41U);
  EXPECT_EQ(markers.markers[2].header.frame_id, "map");
  EXPECT_NEAR(markers.markers[2].points.back().y, 200.0, 1e-9);  // north
  EXPECT_NEAR(markers.markers[2].points.back().z, 80.0, 1e-9);
}

TEST(Conversions, AMissionThereAndBack) {
  const polyfly::Mission mission = polyfly::parseMission(
      "path:\n"
      "  - lines: [[0, 0], [300, 0]]\n"
      "  - dubins: {radius: 50, poses: [[300, 0, 0.5], [100, 420, 3.1416]]}\n"
      "  - spline: [[100, 420], [50, 410], [0, 440]]\n"
      "  - circle: {centre: [0, 500], radius: 70, direction: left}\n",
      "text", {});
  const polyfly::Mission back = toMission(polyfly_ros::toMessage(mission), {});
  ASSERT_EQ(back.segments.size(), mission.segments.size());
  for (std::size_t i = 0; i < mission.segments.size(); ++i) {
    EXPECT_EQ(back.segments[i].index(), mission.segments[i].index());
    for (const double distance : {0.0, 20.0, 1000.0}) {
      const polyfly::PathPoint one = pointAt(mission.segments[i], distance);
      const polyfly::PathPoint other = pointAt(back.segments[i], distance);
      EXPECT_EQ(one.position, other.position);
      EXPECT_EQ(one.tangent, other.tangent);
    }
  }
  EXPECT_EQ(back.curves.size(), 1U);
}

TEST(Conversions, RefusesASplineOfOnePoint) {
  fixedwing_lateral::Mission message;
  message.segments.resize(1);
  message.segments[0].type = fixedwing_lateral::PathSegment::SPLINE;
  message.segments[0].points.resize(1);
  EXPECT_THROW(toMission(message, {}), polyfly::Error);
}

}  // namespace

int main(int argc, char** argv) {
  ::testing::InitGoogleTest(&argc, argv);
  ros::Time::init();
  return RUN_ALL_TESTS();
}
