#include "polyfly_base/time_source.hpp"

#include <algorithm>

namespace polyfly {

void TimeSource::advance(double ros, double wall) noexcept {
  if (ros != ros_) {
    // The silence so far stays where ROS time begins, begins anew or moves again: what is sent in it goes on.
    if (by_wall_ || ros_ == 0.0 || ros < ros_) since_ = ros - silence_;
    if (ros < ros_) least_lead_ = kNoLead;
    silence_ = std::max(ros - since_, 0.0);
    ros_ = ros;
    heard_ = false;
    by_wall_ = false;
    ahead_ = 0.0;
    return;
  }
  if (!simulated_ || !heard_) return;
  const bool never_came = ros == 0.0;
  const bool odometry_goes_on = advance_ >= kStandstill;
  by_wall_ = wall - first_wall_ >= kStandstill && (never_came || odometry_goes_on);
  if (!by_wall_) return;
  silence_ = wall - last_wall_;
  ahead_ = wall - first_wall_;
}

void TimeSource::onOdometry(double ros, double wall, double stamp) noexcept {
  advance(ros, wall);
  const double step = stamp - last_stamp_;
  const bool follows = step >= 0.0 && step <= kGreatestStep;
  if (!heard_) {
    heard_ = true;
    first_wall_ = wall;
    advance_ = 0.0;
  } else if (follows) {
    advance_ += step;
  }
  last_stamp_ = stamp;
  last_wall_ = wall;
  // The clock that came with this odometry may be on its way still.
  const double lead = stamp - ros;
  least_lead_ = follows ? std::min(least_lead_, lead) : lead;
  since_ = simulated_ ? ros + std::max(lead - std::max(least_lead_, 0.0), 0.0) : ros;
  const bool leads = simulated_ && (ros == 0.0 || follows);
  arrival_ = leads ? std::max(ros, stamp) : since_;
  silence_ = 0.0;
}

}  // namespace polyfly
