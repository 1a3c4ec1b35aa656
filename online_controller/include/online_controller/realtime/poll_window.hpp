#pragma once

#include <algorithm>
#include <chrono>

namespace polyfly {

/// When a thread that serves samples of a fixed period looks for the next one without sleeping, and when it
/// rehearses. To wake a thread takes an operating system tens of microseconds, to look takes none; but who
/// looks keeps a processor busy. So it looks for the last `share` of a period, in which the next sample is
/// due, and for as long as one more period when that is late; then it sleeps until there is a sample. It
/// rehearses, and is awake for it, `lead` before a sample is due. One with a lead of its own rehearses only
/// while samples come on time.
class PollWindow {
 public:
  using Clock = std::chrono::steady_clock;

  /// `period` between samples [s]; `share` of it from 0, never looks, to 1, always does; `lead` [s]. 0: 3 %
  /// of the period for one who looks, and no rehearsal for others.
  PollWindow(double period, double share, double lead = 0.0) noexcept
      : opens_(toDuration((1.0 - share) * period)),
        rehearses_(toDuration(lead > 0.0 ? std::max(0.0, period - lead) : (1.0 - kUsualLead) * period)),
        closes_(toDuration(2.0 * period)),
        looks_(share > 0.0),
        paces_(lead > 0.0),
        ever_rehearses_(looks_ || paces_) {}

  /// A sample was served.
  void served(Clock::time_point now) noexcept {
    awaited_ = isOnTime(now) ? std::max(0, awaited_ - 1) : kSteady;
    last_ = now;
    serving_ = true;
    rehearsed_ = false;
  }

  /// The sample that is served now is none that a rehearsal serves.
  void disturbed() noexcept { awaited_ = kSteady; }

  /// Whether there is to be a rehearsal before the next sample.
  bool awaitsRehearsal() const noexcept {
    return ever_rehearses_ && serving_ && !rehearsed_ && (!paces_ || awaited_ == 0);
  }

  /// Whether the next sample is due so soon that a rehearsal of its step keeps the caches warm until then;
  /// once between two samples. Not when half of the lead is over: then it might be in the sample's way.
  bool rehearses(Clock::time_point now) noexcept {
    if (!awaitsRehearsal() || now - last_ < rehearses_) return false;
    rehearsed_ = true;
    return now - last_ <= period() - lead() / 2;
  }

  /// A sample that does not come by then is later than the rehearsal was early.
  Clock::time_point expects() const noexcept { return last_ + period() + lead(); }

  /// How long it may sleep, at most `most` [s]; zero: look again at once.
  double sleep(Clock::time_point now, double most) const noexcept {
    const Clock::duration since = now - last_;
    if (!serving_ || since >= closes_) return most;
    double until = most;
    if (looks_) until = seconds(opens_ - since);
    if (awaitsRehearsal()) until = std::min(until, seconds(rehearses_ - since));
    return std::clamp(until, 0.0, most);
  }

 private:
  static constexpr double kUsualLead = 0.03;  // of the period
  static constexpr int kSteady = 10;          // samples on time after which the next one is expected to be so

  Clock::duration period() const noexcept { return closes_ / 2; }
  Clock::duration lead() const noexcept { return period() - rehearses_; }
  bool isOnTime(Clock::time_point now) const noexcept {
    return serving_ && std::chrono::abs(now - last_ - period()) <= lead();
  }
  static double seconds(Clock::duration duration) noexcept {
    return std::chrono::duration<double>(duration).count();
  }

  static Clock::duration toDuration(double seconds) noexcept {
    return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
  }

  Clock::duration opens_;      // since the last sample
  Clock::duration rehearses_;  // since the last sample
  Clock::duration closes_;     // since the last sample
  bool looks_;
  bool paces_;  // rehearses only while samples come on time
  bool ever_rehearses_;
  bool serving_ = false;
  bool rehearsed_ = false;
  int awaited_ = kSteady;  // samples on time until there are rehearsals
  Clock::time_point last_;
};

}  // namespace polyfly
