#include "progress.hpp"

#include <unistd.h>

#include <cmath>
#include <cstdio>

namespace polyfly {
namespace {

constexpr auto kFirst = std::chrono::milliseconds(500);  // shorter work shows nothing
constexpr auto kOnTerminal = std::chrono::milliseconds(200);
constexpr auto kInLog = std::chrono::seconds(10);
constexpr double kSecondsPerMinute = 60.0;
constexpr double kSecondsPerHour = 3600.0;

constexpr double kWindow = 30.0;   // [s] that a forecast looks back
constexpr double kSpacing = 0.25;  // [s] between two samples
constexpr double kTrusted = 2.0;   // [s] of samples that tell a trend

}  // namespace

std::string duration(double seconds) {
  char text[64];
  if (seconds < kSecondsPerMinute) {
    std::snprintf(text, sizeof text, "%.0f s", std::ceil(seconds));
  } else if (seconds < kSecondsPerHour) {
    const double minutes = std::floor(seconds / kSecondsPerMinute);
    std::snprintf(text, sizeof text, "%.0f min %02.0f s", minutes,
                  std::floor(seconds - minutes * kSecondsPerMinute));
  } else {
    const double hours = std::floor(seconds / kSecondsPerHour);
    std::snprintf(text, sizeof text, "%.0f h %02.0f min", hours,
                  std::floor((seconds - hours * kSecondsPerHour) / kSecondsPerMinute));
  }
  return text;
}

Progress::Progress(bool quiet)
    : next_(start_ + kFirst), quiet_(quiet), terminal_(::isatty(STDERR_FILENO) != 0) {
  if (!terminal_) next_ = start_ + kInLog;
}

Progress::~Progress() { finish(); }

void Progress::show(const std::string& text, double remaining, bool at_least) {
  const Clock::time_point now = Clock::now();
  if (quiet_ || now < next_) return;
  next_ = now + (terminal_ ? Clock::duration(kOnTerminal) : Clock::duration(kInLog));
  std::string line = text;
  if (remaining >= 0.0 && std::isfinite(remaining)) {
    line += std::string(", ") + (at_least ? "at least " : "about ") + duration(remaining) + " left";
  }
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
  open_ = terminal_;
}

void Progress::finish() {
  if (open_) std::fputs("\r\033[K", stderr);
  open_ = false;
}

double Progress::elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

void Forecast::add(double seconds, std::uint64_t regions, std::uint64_t described, std::uint64_t open) {
  if (samples_.size() > 1 && seconds - samples_[samples_.size() - 2].seconds < kSpacing) samples_.pop_back();
  samples_.push_back(
      {seconds, static_cast<double>(regions), static_cast<double>(described), static_cast<double>(open)});
  while (samples_.size() > 2 && seconds - samples_.front().seconds > kWindow) samples_.pop_front();
}

double Forecast::regionsPerSecond() const {
  if (samples_.size() < 2 || samples_.back().seconds <= samples_.front().seconds) return 0.0;
  return (samples_.back().regions - samples_.front().regions) /
         (samples_.back().seconds - samples_.front().seconds);
}

bool Forecast::atLeast() const {
  return samples_.size() < 2 || samples_.back().seconds - samples_.front().seconds < kTrusted ||
         foundPerSet() >= 1.0;
}

// Sets that turned up for each one described, as far back as the open sets reach forward: all of the last
// half minute would still count the growth when the end is near.
double Forecast::foundPerSet() const {
  const Sample& now = samples_.back();
  std::size_t then = samples_.size() - 1;
  while (then > 0 && now.described - samples_[then].described < now.open) --then;
  const double described = now.described - samples_[then].described;
  return described > 0.0 ? 1.0 + (now.open - samples_[then].open) / described : 1.0;
}

double Forecast::remaining() const {
  if (samples_.size() < 2) return -1.0;
  const Sample& now = samples_.back();
  const Sample& then = samples_.front();
  const double described = now.described - then.described;
  if (!(described > 0.0)) return -1.0;
  const double open_takes = now.open * (now.seconds - then.seconds) / described;
  // in the end nothing turns up: if that falls evenly until then, half of what turns up now is its mean
  return atLeast() ? open_takes : open_takes / (1.0 - 0.5 * foundPerSet());
}

}  // namespace polyfly
