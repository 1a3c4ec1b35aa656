#include "validation_ros/filter_bag.hpp"

#include <mav_msgs/RollPitchYawrateThrust.h>
#include <nav_msgs/Odometry.h>
#include <online_controller/CommandFilterStatus.h>

#include "online_controller_ros/conversions.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

using Wish = mav_msgs::RollPitchYawrateThrust;
using Status = online_controller::CommandFilterStatus;

polyfly::FilterLog::Status toFilterStatus(const Status& message) {
  if (message.status > Status::NO_STATE)
    throw polyfly::Error("status is none of those that the message defines");
  polyfly::FilterLog::Status status;
  status.stamp = message.header.stamp.toSec();
  status.status = static_cast<polyfly::FilterStatus>(message.status);
  status.input = {message.x.input, message.y.input, message.z.input};
  return status;
}

}  // namespace

polyfly::FilterLog readFilterBag(const std::string& path, const FilterTopics& topics,
                                 const BagProgress& progress) {
  TopicReader reader({path});
  reader.scan({topics.odometry, topics.wish, topics.status}, progress);
  reader.findNamespace(topics.name_space, topics.wish);
  polyfly::FilterLog log;
  log.source = path;
  reader.require<Wish>(reader.fullName(topics.wish), "--wish", [&log](const Wish& message, double time) {
    log.wishes.push_back({time,
                          message.header.stamp.toSec(),
                          {message.roll, message.pitch, message.yaw_rate, message.thrust.z}});
  });
  reader.require<nav_msgs::Odometry>(reader.fullName(topics.odometry), "--odometry",
                                     [&log](const nav_msgs::Odometry& message, double time) {
                                       log.odometry.push_back({time, toVehicleState(message)});
                                     });
  reader.use<Status>(reader.fullName(topics.status), [&log](const Status& message, double) {
    log.statuses.push_back(toFilterStatus(message));
  });
  reader.read();
  if (log.wishes.empty()) reader.missing(reader.fullName(topics.wish));
  log.share = reader.share();
  log.remarks = reader.remarks();
  return log;
}

}  // namespace polyfly_ros
