#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace polyfly {

/// A step of the stamps of a topic against the times at which the recorder received its messages.
struct ClockStep {
  double at = 0.0;          ///< receive time of the first message behind it [s]
  double by = 0.0;          ///< change of stamp - receive time [s]
  bool of_headers = false;  ///< the clock of the headers jumped; otherwise that of the recorder
};

/// What the stamps of a topic are worth.
struct HeaderClock {
  std::size_t messages = 0;
  std::size_t without_stamp = 0;
  /// Steps of more than kLeastClockStep. Messages that were only received late make none.
  std::vector<ClockStep> steps;
  /// Greatest time by which a recorder that caught up was late [s]; 0 where it was never late by more than
  /// kLeastClockStep.
  double late = 0.0;
  /// Median of stamp - receive time [s]; 0 where no message has a stamp.
  double lead = 0.0;

  /// Whether each message has a stamp, of a clock that did not jump.
  bool isSteady() const;
};

/// Least step of a clock that counts [s].
constexpr double kLeastClockStep = 0.5;

/// Compares stamps with receive times, both in the order of the record, in seconds, as many of one as of the other.
/// A stamp of 0 is none.
HeaderClock headerClock(const std::vector<double>& stamps, const std::vector<double>& received);

/// What is wrong, as clauses without the topic: which clock jumped, by how much, and when, in seconds since `start`.
/// Of many steps the first ones and the number of the others.
std::vector<std::string> clausesOn(const HeaderClock& clock, double start);

}  // namespace polyfly
