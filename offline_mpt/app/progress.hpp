#pragma once

#include <chrono>
#include <cstdint>
#include <deque>
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

  /// Shows `text` if it is time to. `remaining` [s] is added where it is not negative; `at_least` says that
  /// more may turn up.
  void show(const std::string& text, double remaining, bool at_least = false);

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

/// How fast an exploration is, and how long it will take. It cannot know: sets turn up while others are
/// described, until they turn up no more.
class Forecast {
 public:
  /// The state after `seconds`. Calls that follow each other closely count as one.
  void add(double seconds, std::uint64_t regions, std::uint64_t described, std::uint64_t open);

  /// Recent rate. 0 at first.
  double regionsPerSecond() const;

  /// [s]; negative while nothing is known. Where `atLeast()`, what the sets take that are open now; else with
  /// those that they will yield, up to twice as much.
  double remaining() const;
  /// Whether at least as many sets are found as are described.
  bool atLeast() const;

 private:
  struct Sample {
    double seconds, regions, described, open;
  };
  double foundPerSet() const;

  // Samples of the last half minute.
  std::deque<Sample> samples_;
};

/// "12 s", "3 min 05 s", "2 h 10 min"
std::string duration(double seconds);

}  // namespace polyfly
