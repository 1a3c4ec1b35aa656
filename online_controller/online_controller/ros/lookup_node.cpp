#include "online_controller_ros/lookup_node.hpp"

#include <nav_msgs/Odometry.h>
#include <ros/console.h>
#include <std_msgs/Float64.h>
#include <std_msgs/Float64MultiArray.h>

#include <algorithm>
#include <limits>

#include "online_controller_ros/conversions.hpp"
#include "online_controller_ros/map_swap.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

using polyfly::Error;
using polyfly::LookupStatus;
using polyfly::RegionMap;
using polyfly::Signal;
using Status = online_controller::LookupStatus;

constexpr double kWarningPeriod = 1.0;  // [s]
constexpr double kForever = 2e9;        // later than any flight, by the steady clock [s]
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

static_assert(areCounted({Status::INSIDE, Status::OUTSIDE_BOX, Status::OUTSIDE_PARTITION,
                          Status::NOT_FINITE}),
              "the message restates LookupStatus");

// By Status::status and Status::sent.
constexpr const char* kWords[] = {"answered by the map", "a parameter is out of the map's range",
                                  "no region of the map holds the parameters", "a parameter is not finite"};
constexpr const char* kSentWords[] = {"; nothing is sent", "", "; the last inputs are sent again",
                                      "; the safe inputs are sent"};

const std::vector<std::string> kFields{"x",   "y",   "z",   "roll",      "pitch",      "yaw",
                                       "v_x", "v_y", "v_z", "roll_rate", "pitch_rate", "yaw_rate"};

/// In the order of kFields; velocities and rates as the message has them, in the body's frame.
std::vector<double> fieldsOf(const nav_msgs::Odometry& message) {
  const auto& position = message.pose.pose.position;
  const auto &velocity = message.twist.twist.linear, &rate = message.twist.twist.angular;
  const polyfly::EulerAngles angles = polyfly::eulerAngles(toVehicleState(message).attitude);
  return {position.x, position.y, position.z, angles.roll, angles.pitch, angles.yaw,
          velocity.x, velocity.y, velocity.z, rate.x,      rate.y,       rate.z};
}

/// The place of `prefix` NAME in a list of names; its size where there is none.
std::size_t placeIn(const std::vector<std::string>& names, const std::string& prefix,
                    const std::string& text) {
  const auto is_named = [&](const std::string& name) { return text == prefix + name; };
  return static_cast<std::size_t>(std::find_if(names.begin(), names.end(), is_named) - names.begin());
}

std::vector<std::string> namesOf(const std::vector<Signal>& signals) {
  std::vector<std::string> names;
  for (const Signal& signal : signals) names.push_back(signal.name + " [" + signal.unit + "]");
  return names;
}

std::unique_ptr<RegionMap> openComplete(const std::string& path) {
  auto map = std::make_unique<RegionMap>(RegionMap::open(path, polyfly::kGreatestFlownMap));
  if (map->solverStatus() != "complete") throw Error(path + ": solver status: must be 'complete'");
  return map;
}

}  // namespace

LookupNode::LookupNode(const ros::NodeHandle& handle, const ros::NodeHandle& private_handle) try
    : queue_(handle), topics_(onQueue(handle, queue_)) {
  ParameterReader reader(private_handle);
  map_ = openComplete(reader.requiredText("map", "the path of a region map"));
  staged_ = map_.get();
  double stale_periods = 3.0;
  reader("stale_periods", stale_periods, "samples", polyfly::Range{1.0, 10000.0});
  reader("hold_periods", hold_, "samples", polyfly::Range{0.0, 10000.0});
  stale_ = stale_periods * map_->period();
  readSafeInputs(reader);
  theta_.assign(map_->parameters().size(), kNan);
  came_.resize(theta_.size());
  for (std::size_t i = 0; i < theta_.size(); ++i)
    bind(i, reader.text("sources/" + map_->parameters()[i].name, "where the parameter comes from", "topic"));
  for (first_ = 0; std::count(by_input_.begin(), by_input_.end(), first_) > 0;) ++first_;
  if (first_ == theta_.size()) throw Error("sources: at least one parameter must be measured");
  reader.refuseUnknown({"sources", "safe"});
  for (const std::string& name : reader.unread())
    ROS_WARN("look-ups do not know the parameter %s", name.c_str());
  connect(handle);
} catch (const std::exception& error) {
  ROS_FATAL("look-ups do not start: %s", error.what());
  throw;
}

void LookupNode::readSafeInputs(ParameterReader& reader) {
  for (const Signal& input : map_->inputs()) {
    const std::string key = "safe/" + input.name;
    inputs_.push_back(0.0);
    if (!reader.given(key)) continue;
    safe_.push_back(0.0);
    reader(key.c_str(), safe_.back(), input.unit.c_str(), polyfly::Range{input.lower, input.upper});
  }
  if (!safe_.empty() && safe_.size() != inputs_.size()) throw Error("safe: must have all inputs, or none");
}

void LookupNode::bind(std::size_t parameter, const std::string& source) {
  if (source == "topic") return by_topic_.push_back(parameter);
  if (source == "array") return by_array_.push_back(parameter);
  std::vector<std::string> inputs;
  for (const Signal& input : map_->inputs()) inputs.push_back(input.name);
  const std::size_t field = placeIn(kFields, "odometry/", source), input = placeIn(inputs, "last/", source);
  if (field < kFields.size()) {
    by_odometry_.push_back(parameter);
    fields_.push_back(field);
  } else if (input < inputs.size()) {
    by_input_.push_back(parameter);
    last_inputs_.push_back(input);
    theta_[parameter] = 0.0;
    came_[parameter] = ros::SteadyTime(kForever);
  } else {
    throw Error("sources/" + map_->parameters()[parameter].name +
                ": must be topic, array, odometry/FIELD or last/INPUT, got '" + source + "'");
  }
}

template <class Message, class Numbers>
void LookupNode::listen(const std::string& topic, const Places& parameters, const Numbers& numbers) {
  subscribers_.push_back(topics_.subscribe<Message>(
      topic, 1,
      [this, parameters, numbers](const boost::shared_ptr<const Message>& message) {
        take(parameters, numbers(*message));
      },
      ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
}

void LookupNode::connect(const ros::NodeHandle& handle) {
  for (const Signal& input : map_->inputs())
    publishers_.push_back(topics_.advertise<std_msgs::Float64>(input.name, 1));
  status_publisher_ = topics_.advertise<Status>("lookup_status", 1);
  for (const std::size_t i : by_topic_)
    listen<std_msgs::Float64>(map_->parameters()[i].name, {i}, [](const std_msgs::Float64& message) {
      return std::vector<double>{message.data};
    });
  if (!by_array_.empty())
    listen<std_msgs::Float64MultiArray>(
        "parameters", by_array_, [](const std_msgs::Float64MultiArray& message) { return message.data; });
  if (!by_odometry_.empty())
    listen<nav_msgs::Odometry>("odometry", by_odometry_, [this](const nav_msgs::Odometry& message) {
      const std::vector<double> all = fieldsOf(message);
      std::vector<double> values;
      for (const std::size_t field : fields_) values.push_back(all[field]);
      return values;
    });
  timer_ = topics_.createSteadyTimer(ros::WallDuration(map_->period()), [this](const ros::SteadyTimerEvent&) {
    // Before the first answer nothing is sent.
    if (has_answered_ && (ros::SteadyTime::now() - answer_time_).toSec() > stale_) answer();
  });
  ros::NodeHandle config = onQueue(handle, config_queue_);
  own_status_ = config.subscribe<Status>(
      "lookup_status", 1, [this](const Status::ConstPtr& status) { seen_ = status->parameters; });
  swap_service_ = config.advertiseService("swap_map", &LookupNode::onSwap, this);
  config_thread_.start();
}

// An array of another size has no numbers.
void LookupNode::take(const Places& parameters, const std::vector<double>& values) {
  const bool fits = values.size() == parameters.size();
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    theta_[parameters[i]] = fits ? values[i] : kNan;
    came_[parameters[i]] = ros::SteadyTime::now();
  }
  if (std::count(parameters.begin(), parameters.end(), first_) > 0) answer();
}

void LookupNode::answer() {
  next_.swap(map_, [](RegionMap&, const RegionMap&) noexcept {});
  status_.parameters = theta_;
  status_.region = -1;
  const ros::SteadyTime now = ros::SteadyTime::now();
  for (std::size_t i = 0; i < came_.size(); ++i) {
    if (!((now - came_[i]).toSec() > stale_)) continue;
    status_.status = Status::SILENT;
    status_.text = "the parameter " + map_->parameters()[i].name + " does not come";
    return send(false);
  }
  const polyfly::Lookup lookup = map_->evaluate(theta_.data(), inputs_.data());
  status_.status = static_cast<std::uint8_t>(lookup.status);
  status_.text = kWords[status_.status];
  const bool is_inside = lookup.status == LookupStatus::kInside;
  if (is_inside) status_.region = static_cast<std::int32_t>(lookup.region);
  send(is_inside);
}

void LookupNode::send(bool is_inside) {
  missed_ = is_inside ? 0 : missed_ + 1;
  has_answered_ = has_answered_ || is_inside;
  answer_time_ = ros::SteadyTime::now();
  if (is_inside) {
    status_.sent = Status::ANSWER;
  } else if (has_answered_ && missed_ <= hold_) {
    status_.sent = Status::LAST;
  } else if (has_answered_ && !safe_.empty()) {
    status_.sent = Status::SAFE;
    inputs_ = safe_;
  } else {
    status_.sent = Status::NOTHING;
  }
  status_.inputs.clear();
  for (std::size_t i = 0; status_.sent != Status::NOTHING && i < inputs_.size(); ++i) {
    const Signal& input = map_->inputs()[i];
    std_msgs::Float64 message;
    message.data = inputs_[i] = std::clamp(inputs_[i], input.lower, input.upper);
    publishers_[i].publish(message);
    status_.inputs.push_back(message.data);
  }
  for (std::size_t i = 0; i < by_input_.size(); ++i) theta_[by_input_[i]] = inputs_[last_inputs_[i]];
  status_.header.stamp = ros::Time::now();
  status_.text += kSentWords[status_.sent];
  status_publisher_.publish(status_);
  ++status_.sequence;
  if (!is_inside) ROS_WARN_THROTTLE(kWarningPeriod, "look-ups: %s", status_.text.c_str());
}

bool LookupNode::onSwap(online_controller::SwapMap::Request& request,
                        online_controller::SwapMap::Response& response) {
  try {
    std::unique_ptr<RegionMap> next = openComplete(request.path);
    if (namesOf(next->parameters()) != namesOf(staged_->parameters()) ||
        namesOf(next->inputs()) != namesOf(staged_->inputs()))
      throw Error(request.path + ": parameters and inputs must be those of the map in force");
    requireSamePeriod(*staged_, *next);
    requireSimilar(*staged_, *next, seen_, request.most_change);
    staged_ = next.get();
    next_.stage(std::move(next));
    response.success = 1;
    response.message = request.path;
    ROS_INFO("look-ups: %s from the next parameters on", request.path.c_str());
  } catch (const Error& error) {
    response.success = 0;
    response.message = std::string(error.what()) + "; the map in force stays";
    ROS_ERROR("look-ups: %s", response.message.c_str());
  }
  return true;
}

}  // namespace polyfly_ros
