#include "record_follower.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "identification/loop_record.hpp"
#include "online_controller/laws/axis.hpp"
#include "region_maps/region_map.hpp"
#include "validation/difference.hpp"

namespace polyfly {
namespace {

// Samples in a row whose commands agree until record and replay go together again.
constexpr std::size_t kAgreeing = 50;
// Of the tolerance: what these samples may differ by. What the replay does not know yet fades, and this much may stay.
constexpr double kAgreement = 0.1;
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

bool holds(const std::set<double>& stamps, double from, double to) {
  const auto next = stamps.upper_bound(from);
  return next != stamps.end() && *next < to;
}

}  // namespace

RecordFollower::RecordFollower(const FlightLog& log, const AxisMaps& maps, double mass, double tolerance)
    : maps_(maps),
      mass_(mass),
      tolerance_(tolerance),
      commands_(log.commandsByStamp()),
      statuses_(log.statusesByStamp()),
      silences_(log.silences.begin(), log.silences.end()),
      lost_(log.lost),
      is_lost_somewhere_(log.share && !log.share->isWhole() && log.lost.empty()) {
  TimeSeries odometry;
  for (const VehicleState& state : log.odometry) {
    odometry.time.push_back(state.stamp);
    if (commands_.count(state.stamp) == 0) alone_.insert(state.stamp);
  }
  const std::set<double> stamps(odometry.time.begin(), odometry.time.end());
  for (const auto& [stamp, command] : commands_) {
    if (stamps.count(stamp) == 0 && silences_.count(stamp) == 0) alone_.insert(stamp);
  }
  longest_ = kHolePeriods * typicalPeriod(odometry, kLongestPeriod);
  // A status tells how many there were before.
  may_begin_late_ = log.statuses.empty() || log.statuses.front().sequence > 0;
}

// A reference alone may be lost, so that odometry and commands show nothing.
bool RecordFollower::isHole(double from, double to) const {
  const auto overlaps = [&](const TimeSpan& span) { return span.from < to && from < span.to; };
  return std::any_of(lost_.begin(), lost_.end(), overlaps) || holds(alone_, from, to) ||
         (to - from > longest_ && !holds(silences_, from, to));
}

bool RecordFollower::wasLostBefore(double stamp) const {
  return is_lost_somewhere_ ||
         std::any_of(lost_.begin(), lost_.end(), [&](const TimeSpan& span) { return span.from < stamp; });
}

const AttitudeCommand* RecordFollower::follow(std::vector<ReplaySample>* samples) {
  ReplaySample& sample = samples->back();
  const double stamp = sample.state.stamp;
  const bool is_first = samples->size() == 1;
  if (!is_first && isHole((*samples)[samples->size() - 2].state.stamp, stamp)) {
    is_proven_ = false;
    agreeing_ = 0;
  }
  const auto command = commands_.find(stamp);
  const double apart =
      command == commands_.end() ? 0.0 : distance(*command->second, sample.report.command, mass_);
  const bool agrees = apart <= tolerance_;
  const auto status = statuses_.find(stamp);
  const bool has_errors = status != statuses_.end() && !answeredOther(*status->second, sample.report, maps_);
  if (!ignorance_ && !agrees) {
    if (is_first && may_begin_late_) {
      ignorance_ = Ignorance::kBegun;
    } else if (!is_proven_) {
      ignorance_ = Ignorance::kMissing;
    } else if (agreeing_ > 0 && status != statuses_.end() && !has_errors) {
      const bool was_lost = wasLostBefore(stamp);
      ignorance_ = was_lost ? Ignorance::kMissing : Ignorance::kAltered;
      if (!was_lost) first_altered_ = samples->size() - 1;
    }
  }
  sample.ignorance = ignorance_;
  sample.is_known = !ignorance_ || has_errors;
  judgeAltered(has_errors, samples);
  const bool agrees_well = ignorance_ ? apart <= kAgreement * tolerance_ : agrees;
  agreeing_ = agrees_well ? agreeing_ + 1 : 0;
  if (agreeing_ >= kAgreeing) is_proven_ = !is_lost_somewhere_;
  if (ignorance_ && agreeing_ >= kAgreeing) ignorance_.reset();
  went_together_ = went_together_ || !ignorance_;
  // What is left of the difference goes on fading.
  was_apart_ = was_apart_ || ignorance_;
  return was_apart_ && command != commands_.end() && apart > 0.0 ? command->second : nullptr;
}

// Where the node goes on answering other errors it was another flight, and all of it counts.
void RecordFollower::judgeAltered(bool has_errors, std::vector<ReplaySample>* samples) {
  if (!first_altered_ || !ignorance_) return;
  if (has_errors) {
    first_altered_.reset();
  } else if (samples->size() - *first_altered_ >= kMostAltered) {
    for (std::size_t place = *first_altered_; place < samples->size(); ++place) {
      (*samples)[place].ignorance.reset();
      (*samples)[place].is_known = true;
    }
    first_altered_.reset();
    ignorance_.reset();
    agreeing_ = 0;
  }
}

}  // namespace polyfly
