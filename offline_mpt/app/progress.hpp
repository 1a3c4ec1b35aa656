#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace polyfly {

/// One line on standard error about long work: rewritten in place on a terminal, else a new line now and
/// then.
class Progress {
 public:
  explicit Progress(bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Shows `text` and the time that has passed, if it is time to.
  void show(const std::string& text);

  /// Ends the line.
  void finish();

  /// Time since construction [s].
  double elapsed() const;

 private:
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start_ = Clock::now();
  Clock::time_point next_;
  const bool quiet_;
  const bool terminal_;
  // Whether the terminal shows an unfinished line.
  bool open_ = false;
};

/// How fast a count has grown in the last quarter or half minute.
class RecentRate {
 public:
  void add(double seconds, std::uint64_t count);

  /// 0 at first.
  double perSecond() const;

 private:
  struct Sample {
    double seconds = 0.0, count = 0.0;
  };
  bool started_ = false;
  Sample before_, after_, now_;
};

/// "12 s", "3 min 05 s", "2 h 10 min"
std::string duration(double seconds);

}  // namespace polyfly
