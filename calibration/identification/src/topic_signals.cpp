#include "topic_signals.hpp"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "identification/flight_signals.hpp"
#include "identification/header_clock.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Greatest difference between the length of a quaternion and 1.
constexpr double kQuaternionLength = 0.1;

const char* const kQuaternion[] = {".w", ".x", ".y", ".z"};
const char* const kTwist[] = {"twist.twist.linear.x", "twist.twist.linear.y", "twist.twist.linear.z"};
const char* const kVelocity[] = {"vx", "vy", "vz"};
const char* const kOdometryAttitude = "pose.pose.orientation";

Eigen::Quaterniond quaternion(const double* wxyz) {
  Eigen::Quaterniond attitude(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  const bool good = std::abs(attitude.norm() - 1.0) <= kQuaternionLength;
  if (good) {
    attitude.normalize();
  } else {
    attitude.coeffs().setConstant(std::nan(""));
  }
  return attitude;
}

}  // namespace

TopicSignals::TopicSignals(const BagConnection& connection, std::vector<FieldUse> uses, bool with_velocity)
    : topic_(connection.topic),
      layout_(connection.type, connection.definition),
      uses_(std::move(uses)),
      with_velocity_(with_velocity) {
  paths_.emplace_back("header.stamp");
  for (const FieldUse& use : uses_) {
    names_.push_back(use.signal);
    if (use.angle.empty()) {
      paths_.push_back(use.path);
    } else {
      for (const char* part : kQuaternion) paths_.push_back(use.path + part);
    }
  }
  if (with_velocity_) {
    for (const char* part : kQuaternion) paths_.push_back(std::string(kOdometryAttitude) + part);
    paths_.insert(paths_.end(), std::begin(kTwist), std::end(kTwist));
    names_.insert(names_.end(), std::begin(kVelocity), std::end(kVelocity));
  }
  for (std::size_t i = 1; i < paths_.size(); ++i) {
    if (!layout_.has(paths_[i])) {
      throw Error("topic " + topic_ + ": " + connection.type + " has no number " + paths_[i]);
    }
  }
  values_.resize(names_.size());
}

void TopicSignals::add(const BagMessage& message) {
  const auto numbers = layout_.numbers(message.data, message.size, paths_);
  if (!numbers) {
    ++misfits_;
    return;
  }
  received_.push_back(message.time());
  stamps_.push_back(layout_.has(paths_.front()) ? numbers->front() : 0.0);
  std::size_t at = 1;
  std::size_t name = 0;
  for (const FieldUse& use : uses_) {
    if (use.angle.empty()) {
      values_[name++].push_back(use.scale * (*numbers)[at++]);
    } else {
      const Eigen::Quaterniond q = quaternion(numbers->data() + at);
      values_[name++].push_back(use.scale * angleOf(q.w(), q.x(), q.y(), q.z(), use.angle));
      at += std::size(kQuaternion);
    }
  }
  if (!with_velocity_) return;
  const Eigen::Quaterniond attitude = quaternion(numbers->data() + at);
  const Eigen::Vector3d velocity =
      attitude * Eigen::Map<const Eigen::Vector3d>(numbers->data() + at + std::size(kQuaternion));
  for (Eigen::Index i = 0; i < 3; ++i) values_[name++].push_back(velocity[i]);
}

std::vector<std::string> TopicSignals::names() const {
  return received_.empty() ? std::vector<std::string>{} : names_;
}

std::vector<std::string> TopicSignals::remarks(double start) const {
  std::vector<std::string> clauses;
  if (misfits_ > 0)
    clauses.push_back(std::to_string(misfits_) +
                      " messages are not what their definition says and were left out");
  if (received_.empty()) return clauses;
  if (!layout_.has(paths_.front())) {
    clauses.emplace_back("the messages have no header");
    return clauses;
  }
  const std::vector<std::string> of_clock = clausesOn(clock(), start);
  clauses.insert(clauses.end(), of_clock.begin(), of_clock.end());
  return clauses;
}

std::map<std::string, TimeSeries> TopicSignals::series(double start, SignalClock which) const {
  const std::vector<double>& times = which == SignalClock::kHeaders ? stamps_ : received_;
  std::vector<std::size_t> order(times.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  // Between far steps only: that a clock was set back must still be seen.
  auto piece = order.begin();
  for (auto at = order.begin(); at != order.end(); ++at) {
    if (at + 1 != order.end() && !isFarStep(times[*at], times[at[1]])) continue;
    std::stable_sort(piece, at + 1,
                     [&times](std::size_t one, std::size_t other) { return times[one] < times[other]; });
    piece = at + 1;
  }
  std::map<std::string, TimeSeries> result;
  for (std::size_t name = 0; name < names_.size(); ++name) {
    TimeSeries& one = result[names_[name]];
    for (const std::size_t i : order) {
      one.time.push_back(times[i] - start);
      one.value.push_back(values_[name][i]);
    }
  }
  return result;
}

}  // namespace polyfly
