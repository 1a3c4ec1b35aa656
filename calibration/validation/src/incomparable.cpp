#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "difference_collector.hpp"
#include "identification/loop_record.hpp"
#include "online_controller/laws/axis.hpp"
#include "region_maps/region_map.hpp"
#include "validation_parts.hpp"

namespace polyfly {
namespace {

// Samples in a row whose commands agree until record and replay go together again.
constexpr std::size_t kAgreeing = 20;
// Periods of odometry without a sample that are a hole.
constexpr double kHolePeriods = 1.5;
// Greatest number of messages in a row that are altered where the record goes on behind them.
constexpr std::size_t kMostAltered = 10;
// Greatest difference of errors that the same odometry and reference lead to [m, m/s].
constexpr double kSameError = 1e-6;

// Greatest difference of two commands, thrust per mass; NaN if one is not finite.
double distance(const AttitudeCommand& one, const AttitudeCommand& other, double mass) {
  const double angle = worse(std::abs(one.roll - other.roll), std::abs(one.pitch - other.pitch));
  return worse(angle,
               worse(std::abs(one.yaw_rate - other.yaw_rate), std::abs(one.thrust - other.thrust) / mass));
}

// Whether the controller answered other errors of position or velocity than the record leads to.
bool answeredOther(const FlightLog::Status& status, const ControlReport& report, const AxisMaps& maps) {
  for (std::size_t axis = 0; axis < maps.size(); ++axis) {
    const AxisReport& replayed = report.axis[axis];
    if (status.theta[axis].size() != static_cast<std::size_t>(replayed.size)) return true;
    for (std::size_t index = 0; index < status.theta[axis].size(); ++index) {
      const std::string& name = maps[axis]->parameters()[index].name;
      if (name != kAxisNames[axis].position_error && name != kAxisNames[axis].velocity_error) continue;
      if (!(std::abs(status.theta[axis][index] - replayed.theta[index]) <= kSameError)) return true;
    }
  }
  return false;
}

// A sample with what the record tells of it.
struct Recorded {
  bool commands_agree = true;
  // Whether the node answered these errors; none where its status is not recorded.
  std::optional<bool> errors_agree;
  // Whether something is missing before the sample.
  bool behind_hole = false;
};

using Commands = std::map<double, const AttitudeCommand*>;

Commands commandsOf(const FlightLog& log) {
  Commands commands;
  for (const FlightLog::Command& command : log.commands) commands[command.stamp] = &command.command;
  return commands;
}

// Where the record lacks something: a pause that the node did not notice, or what only one topic holds.
class Holes {
 public:
  Holes(const FlightLog& log, const Commands& commands)
      : silences_(log.silences.begin(), log.silences.end()) {
    TimeSeries odometry;
    for (const VehicleState& state : log.odometry) {
      odometry.time.push_back(state.stamp);
      if (commands.count(state.stamp) == 0) alone_.insert(state.stamp);
    }
    const std::set<double> stamps(odometry.time.begin(), odometry.time.end());
    for (const auto& [stamp, command] : commands) {
      if (stamps.count(stamp) == 0 && silences_.count(stamp) == 0) alone_.insert(stamp);
    }
    longest_ = kHolePeriods * typicalPeriod(odometry, kLongestPeriod);
  }
  bool between(double from, double to) const {
    return holds(alone_, from, to) || (to - from > longest_ && !holds(silences_, from, to));
  }

 private:
  static bool holds(const std::set<double>& stamps, double from, double to) {
    const auto next = stamps.upper_bound(from);
    return next != stamps.end() && *next < to;
  }

  std::set<double> silences_;
  // Stamps of odometry without command, or of commands without odometry.
  std::set<double> alone_;
  double longest_ = 0.0;
};

std::vector<Recorded> recordedSamples(const FlightLog& log, const std::vector<ReplaySample>& samples,
                                      const AxisMaps& maps, double mass, double tolerance) {
  const Commands commands = commandsOf(log);
  const Holes holes(log, commands);
  std::map<double, const FlightLog::Status*> statuses;
  for (const FlightLog::Status& status : log.statuses) {
    if (status.reason != ControlReason::kStale) statuses[status.stamp] = &status;
  }
  std::vector<Recorded> all;
  for (const ReplaySample& sample : samples) {
    Recorded one;
    const double stamp = sample.state.stamp;
    const auto command = commands.find(stamp);
    if (command != commands.end())
      one.commands_agree = distance(*command->second, sample.report.command, mass) <= tolerance;
    const auto status = statuses.find(stamp);
    if (status != statuses.end()) one.errors_agree = !answeredOther(*status->second, sample.report, maps);
    one.behind_hole = !all.empty() && holes.between(samples[all.size() - 1].state.stamp, stamp);
    all.push_back(one);
  }
  return all;
}

// Whether the node answered other errors here, but soon the recorded ones again.
bool isAltered(const std::vector<Recorded>& samples, std::size_t place) {
  if (samples[place].errors_agree.value_or(true)) return false;
  const std::size_t end = std::min(samples.size(), place + kMostAltered);
  return std::any_of(samples.begin() + static_cast<std::ptrdiff_t>(place),
                     samples.begin() + static_cast<std::ptrdiff_t>(end),
                     [](const Recorded& one) { return one.errors_agree.value_or(false); });
}

// Follows the samples. A difference counts while record and replay go together, which they no longer do where the
// replay does not know what the controller knew.
class Follower {
 public:
  Follower(const FlightLog& log, const std::vector<ReplaySample>& samples, std::vector<Recorded> recorded)
      : samples_(samples), recorded_(std::move(recorded)), has_statuses_(!log.statuses.empty()) {
    // A status tells how many commands there were before.
    const bool may_begin_late = !has_statuses_ || log.statuses.front().sequence > 0;
    if (may_begin_late && !recorded_.empty() && !recorded_.front().commands_agree) part(0, Ignorance::kBegun);
  }

  // Whether the commands are compared.
  std::vector<bool> follow() {
    std::vector<bool> compared;
    for (std::size_t place = 0; place < recorded_.size(); ++place) {
      const Recorded& one = recorded_[place];
      if (one.behind_hole) {
        is_proven_ = false;
        agreeing_ = 0;
        hole_ = samples_[place - 1].state.stamp;
      }
      if (is_together_ && !one.commands_agree) {
        if (!is_proven_) {
          part(place, Ignorance::kMissing);
        } else if (agreeing_ > 0 && isAltered(recorded_, place)) {
          part(place, Ignorance::kAltered);
        }
      }
      compared.push_back(is_together_);
      agreeing_ = one.commands_agree ? agreeing_ + 1 : 0;
      is_proven_ = is_proven_ || agreeing_ >= kAgreeing;
      if (is_together_) continue;
      stretches_.back().to = samples_[place].state.stamp;
      ++stretches_.back().samples;
      is_together_ = agreeing_ >= kAgreeing;
    }
    // Where nothing tells that the recording begins in flight, commands that never agree are others.
    if (has_statuses_ || is_together_ || stretches_.size() > 1 || stretches_[0].cause != Ignorance::kBegun)
      return compared;
    stretches_.clear();
    return std::vector<bool>(compared.size(), true);
  }
  std::vector<IncomparableStretch> stretches() { return std::move(stretches_); }

 private:
  void part(std::size_t place, Ignorance cause) {
    const double stamp = samples_[place].state.stamp;
    stretches_.push_back({cause, cause == Ignorance::kMissing ? hole_ : stamp, stamp, 0});
    is_together_ = false;
  }

  const std::vector<ReplaySample>& samples_;
  std::vector<Recorded> recorded_;
  bool has_statuses_;
  std::vector<IncomparableStretch> stretches_;
  bool is_together_ = true;
  // Whether the commands agreed since the last hole.
  bool is_proven_ = true;
  // Samples in a row, up to the last one.
  std::size_t agreeing_ = 0;
  // Stamp of the sample before the last hole [s].
  double hole_ = 0.0;
};

}  // namespace

ComparableSamples comparableSamples(const FlightLog& log, const std::vector<ReplaySample>& samples,
                                    const AxisMaps& maps, double mass, double tolerance) {
  const std::vector<Recorded> recorded = recordedSamples(log, samples, maps, mass, tolerance);
  Follower follower(log, samples, recorded);
  const std::vector<bool> compared = follower.follow();
  ComparableSamples result;
  result.stretches = follower.stretches();
  if (result.stretches.empty()) return result;
  for (std::size_t place = 0; place < samples.size(); ++place) {
    if (compared[place]) result.compared.push_back(samples[place]);
    if (compared[place] || recorded[place].errors_agree.value_or(false))
      result.known.push_back(samples[place]);
  }
  return result;
}

}  // namespace polyfly
