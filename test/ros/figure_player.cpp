#include "figure_player.hpp"

#include <nav_msgs/Path.h>

#include <string>

#include "conversions.hpp"
#include "polyfly_test/flight_figure.hpp"
#include "read_options.hpp"

namespace polyfly_ros {
namespace {

constexpr double kPollTime = 0.02;  // wall time between looks at the subscribers [s]

}  // namespace

FigurePlayer::FigurePlayer(const ros::NodeHandle& nh, const ros::NodeHandle& private_nh) : nh_(nh) {
  polyfly::FigureOptions options;
  OptionsReader reader(private_nh, "figure");
  polyfly::visitFigureOptions(options, reader);
  reader.refuseUnknown();
  const polyfly::FlightFigure figure(options);

  const double start = readNumber(private_nh, "start_stamp", 10.0, 0.001, 4e9);
  subscribers_ = static_cast<int>(readNumber(private_nh, "subscribers", subscribers_, 0.0, 100.0));
  std::string frame = "world";
  private_nh.param("frame", frame, frame);
  trajectory_ = toTrajectory(figure.sample(), options.sample_period, ros::Time(start), frame);

  constexpr bool kLatched = true;
  trajectory_pub_ =
      nh_.advertise<trajectory_msgs::MultiDOFJointTrajectory>("command/trajectory", 1, kLatched);
  path_pub_ = nh_.advertise<nav_msgs::Path>("command/path", 1, kLatched);
  path_pub_.publish(toPath(trajectory_));
  timer_ = nh_.createWallTimer(ros::WallDuration(kPollTime),
                               [this](const ros::WallTimerEvent&) { publishWhenHeard(); });
}

void FigurePlayer::publishWhenHeard() {
  if (static_cast<int>(trajectory_pub_.getNumSubscribers()) < subscribers_) {
    return;
  }
  trajectory_pub_.publish(trajectory_);
  timer_.stop();
}

}  // namespace polyfly_ros
