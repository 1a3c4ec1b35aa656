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

void Progress::show(const std::string& text) {
  const Clock::time_point now = Clock::now();
  if (quiet_ || now < next_) return;
  next_ = now + (terminal_ ? Clock::duration(kOnTerminal) : Clock::duration(kInLog));
  const std::string line = text + ", " + duration(elapsed()) + " so far";
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
  open_ = terminal_;
}

std::function<void(std::uint64_t, std::uint64_t)> Progress::counter(const std::string& before,
                                                                    const std::string& after) {
  return [this, before, after](std::uint64_t done, std::uint64_t total) {
    show(before + std::to_string(done) + " of " + std::to_string(total) + after);
  };
}

void Progress::finish() {
  if (open_) std::fputs("\r\033[K", stderr);
  open_ = false;
}

double Progress::elapsed() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

}  // namespace polyfly
