#include "validation/filter_replay.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// A silence that lasts longer is no flight: the recorder's clock was set, or it paused.
constexpr double kLongestSilence = 60.0;  // [s]
constexpr double kNoNumber = std::numeric_limits<double>::quiet_NaN();

// The node's rules, by the recorder's clock.
class FilterRun {
 public:
  FilterRun(const FilterLog& log, const FilterTiming& timing, CommandFilter& filter)
      : log_(log),
        silence_(timing.silence_periods * filter.period()),
        stale_(timing.stale_periods * filter.period()),
        filter_(filter) {}

  FilterReplay run() {
    for (const FilterLog::Wish& wish : log_.wishes) {
      answerSilence(wish.received);
      if (isEarly(wish)) {
        ++replay_.early;
        continue;
      }
      answered_stamp_ = wish.stamp;
      answered_time_ = wish.received;
      answer(wish.received, wish.stamp, wish.command);
    }
    if (!log_.odometry.empty()) answerSilence(log_.odometry.back().received);
    hold();
    return std::move(replay_);
  }

 private:
  bool isEarly(const FilterLog::Wish& wish) const {
    const double since = wish.stamp - answered_stamp_.value_or(-std::numeric_limits<double>::infinity());
    return since >= 0.0 && since < kLeastFilterPeriod * filter_.period() && wish.stamp != 0.0;
  }

  // Once in each period of a silence that lasts until `end`, or for kLongestSilence.
  void answerSilence(double end) {
    if (!answered_stamp_) return;
    end = std::min(end, answered_time_ + kLongestSilence);
    const AttitudeCommand none = {kNoNumber, kNoNumber, kNoNumber, kNoNumber};
    for (std::size_t k = 0;; ++k) {
      const double time = answered_time_ + silence_ + static_cast<double>(k) * filter_.period();
      if (time >= end) return;
      answer(time, std::nullopt, none);
    }
  }

  void answer(double time, std::optional<double> stamp, const AttitudeCommand& wish) {
    while (next_ < log_.odometry.size() && log_.odometry[next_].received <= time) ++next_;
    FilterSample sample;
    sample.time = time;
    sample.stamp = stamp;
    sample.wished = std::isfinite(wish.roll) && std::isfinite(wish.pitch) && std::isfinite(wish.yaw_rate) &&
                    std::isfinite(wish.thrust);
    const bool fresh = next_ > 0 && time - log_.odometry[next_ - 1].received <= stale_;
    if (fresh) sample.state = log_.odometry[next_ - 1].state;
    sample.report = fresh ? filter_.step(sample.state, wish) : filter_.stepWithoutState();
    for (std::size_t i = 0; i < sample.distance.size(); ++i) sample.distance[i] = distanceOf(sample, i);
    replay_.samples.push_back(sample);
  }

  double distanceOf(const FilterSample& sample, std::size_t axis) const {
    const SafetyFilterProblem* problem = filter_.problem(axis);
    if (problem == nullptr || sample.report.status == FilterStatus::kNoState) return kNoNumber;
    return edgeDistance(*problem, sample.report.axes[axis].xi.data());
  }

  void hold() {
    for (std::size_t i = 0; i < replay_.samples.size(); ++i) {
      const bool last = i + 1 == replay_.samples.size();
      replay_.samples[i].held =
          last ? filter_.period() : std::min(replay_.samples[i + 1].time - replay_.samples[i].time, silence_);
    }
  }

  const FilterLog& log_;
  double silence_;  // [s]
  double stale_;    // [s]
  CommandFilter& filter_;
  FilterReplay replay_;
  // Of the odometry that has not arrived yet.
  std::size_t next_ = 0;
  std::optional<double> answered_stamp_;
  double answered_time_ = 0.0;
};

}  // namespace

double edgeDistance(const SafetyFilterProblem& problem, const double* xi) {
  const SafeSet& set = *problem.safe_set;
  const std::vector<Signal> states = problem.augmentedStates();
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < set.H.rows(); ++i) {
    double slack = set.k[i], length = 0.0;
    for (Eigen::Index j = 0; j < set.H.cols(); ++j) {
      const Signal& state = states[static_cast<std::size_t>(j)];
      const double scaled = set.H(i, j) * 0.5 * (state.upper - state.lower);
      slack -= set.H(i, j) * xi[j];
      length += scaled * scaled;
    }
    least = std::min(least, slack / std::sqrt(length));
  }
  return least;
}

FilterReplay replayFilter(const FilterLog& log, const FilterTiming& timing, CommandFilter& filter) {
  if (log.wishes.empty()) throw Error(log.source + ": no command to filter");
  return FilterRun(log, timing, filter).run();
}

}  // namespace polyfly
