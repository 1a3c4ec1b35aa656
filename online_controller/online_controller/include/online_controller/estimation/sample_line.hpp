#pragma once

#include <cmath>

#include "mpc_core/observer.hpp"

namespace polyfly {

/// The time line of an observer: whole control periods from sample to sample, so that jitter of the stamps does not add up.
class SampleLine {
 public:
  struct Step {
    /// Control periods since the sample before. 0: it was of the same period. More than kMaxPeriods of DisturbanceObserver:
    /// the observer starts on this sample.
    int periods = 0;
    /// Whether time went back.
    bool is_other_flight = false;

    bool continues() const noexcept { return periods <= DisturbanceObserver::kMaxPeriods; }
  };

  /// `period` is the control period [s].
  explicit SampleLine(double period) : period_(period) {}

  /// Goes on to a sample.
  Step next(double stamp) noexcept {
    const double late = (stamp - until_) / period_;
    Step step{DisturbanceObserver::kMaxPeriods + 1, running_ && late < -0.5};
    if (running_ && !step.is_other_flight && late < DisturbanceObserver::kMaxPeriods + 0.5)
      step.periods = static_cast<int>(std::lround(late));
    if (step.periods == 0) return step;
    until_ = step.continues() ? until_ + step.periods * period_ : stamp;
    running_ = true;
    return step;
  }

  /// The next sample starts anew.
  void restart() noexcept { running_ = false; }

  /// Goes on where `other` is, by its own period.
  void transferState(const SampleLine& other) noexcept {
    until_ = other.until_;
    running_ = other.running_;
  }

 private:
  double period_;
  // Time up to which was counted [s].
  double until_ = 0.0;
  bool running_ = false;
};

}  // namespace polyfly
