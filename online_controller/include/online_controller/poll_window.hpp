#pragma once

#include <algorithm>
#include <chrono>

namespace polyfly {

/// When a thread that serves samples of a fixed period looks for the next one without sleeping. To wake a
/// thread takes an operating system tens of microseconds, to look takes none; but who looks keeps a processor
/// busy. So it looks for the last `share` of a period, in which the next sample is due, and for as long as
/// one more period when that is late; then it sleeps until there is a sample.
class PollWindow {
 public:
  using Clock = std::chrono::steady_clock;

  /// `period` between samples [s]; `share` of it from 0, never looks, to 1, always does.
  PollWindow(double period, double share) noexcept
      : opens_(toDuration((1.0 - share) * period)),
        rehearses_(toDuration((1.0 - kRehearsalLead) * period)),
        closes_(toDuration(2.0 * period)),
        ever_(share > 0.0) {}

  /// A sample was served.
  void served(Clock::time_point now) noexcept {
    last_ = now;
    serving_ = true;
    rehearsed_ = false;
  }

  /// Whether the next sample is due so soon that a rehearsal of its step keeps the caches warm until then;
  /// once between two samples.
  bool rehearses(Clock::time_point now) noexcept {
    if (!ever_ || !serving_ || rehearsed_ || now - last_ < rehearses_) return false;
    rehearsed_ = true;
    return true;
  }

  /// How long it may sleep, at most `most` [s]; zero: look again at once.
  double sleep(Clock::time_point now, double most) const noexcept {
    const Clock::duration since = now - last_;
    if (!ever_ || !serving_ || since >= closes_) return most;
    return std::clamp(std::chrono::duration<double>(opens_ - since).count(), 0.0, most);
  }

 private:
  static constexpr double kRehearsalLead = 0.03;  // before a sample that is in time, of the period

  static Clock::duration toDuration(double seconds) noexcept {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  Clock::duration opens_;      // since the last sample
  Clock::duration rehearses_;  // since the last sample
  Clock::duration closes_;     // since the last sample
  bool ever_;
  bool serving_ = false;
  bool rehearsed_ = false;
  Clock::time_point last_;
};

}  // namespace polyfly
