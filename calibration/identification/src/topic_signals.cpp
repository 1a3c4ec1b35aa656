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
constexpr std::size_t kQuaternionSize = 4;

double valueOf(const FieldUse& use, const double* numbers) {
  if (use.part.empty()) return use.scale * numbers[0];
  Eigen::Quaterniond attitude(numbers[0], numbers[1], numbers[2], numbers[3]);
  if (!(std::abs(attitude.norm() - 1.0) <= kQuaternionLength)) return std::nan("");
  attitude.normalize();
  if (use.paths.size() == kQuaternionSize)
    return use.scale * angleOf(attitude.w(), attitude.x(), attitude.y(), attitude.z(), use.part);
  return (attitude * Eigen::Map<const Eigen::Vector3d>(numbers + kQuaternionSize))[use.part.front() - 'x'];
}

}  // namespace

FieldUse fieldUse(const std::string& signal, const std::string& place, double scale, int rank) {
  const std::size_t star = place.find('*');
  const std::size_t dot = place.rfind('.');
  const std::string last = dot == std::string::npos ? "" : place.substr(dot + 1);
  FieldUse use = {signal, {}, last, scale, rank};
  if (star == std::string::npos && last != "roll" && last != "pitch" && last != "yaw")
    return {signal, {place}, "", scale, rank};
  for (const char* part : {".w", ".x", ".y", ".z"})
    use.paths.push_back(place.substr(0, std::min(star, dot)) + part);
  for (const char* axis : {".x", ".y", ".z"}) {
    if (star != std::string::npos) use.paths.push_back(place.substr(star + 1, dot - star - 1) + axis);
  }
  return use;
}

TopicSignals::TopicSignals(const BagConnection& connection, std::vector<FieldUse> uses)
    : type_(connection.type), layout_(connection.type, connection.definition), uses_(std::move(uses)) {
  paths_.emplace_back("header.stamp");
  for (const FieldUse& use : uses_) paths_.insert(paths_.end(), use.paths.begin(), use.paths.end());
  for (std::size_t i = 1; i < paths_.size(); ++i) {
    if (!layout_.has(paths_[i]))
      throw Error("topic " + connection.topic + ": " + connection.type + " has no number " + paths_[i]);
  }
  values_.resize(uses_.size());
}

void TopicSignals::add(const BagMessage& message) {
  const auto numbers = layout_.numbers(message.data, message.size, paths_);
  if (!numbers) {
    ++misfits_;
    return;
  }
  received_.push_back(message.time());
  stamps_.push_back(layout_.has(paths_.front()) ? numbers->front() : 0.0);
  const double* at = numbers->data() + 1;
  for (std::size_t i = 0; i < uses_.size(); ++i) {
    values_[i].push_back(valueOf(uses_[i], at));
    at += uses_[i].paths.size();
  }
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

TimeSeries TopicSignals::series(std::size_t use, double start, SignalClock which) const {
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
  TimeSeries series;
  for (const std::size_t i : order) {
    series.time.push_back(times[i] - start);
    series.value.push_back(values_[use][i]);
  }
  return series;
}

}  // namespace polyfly
