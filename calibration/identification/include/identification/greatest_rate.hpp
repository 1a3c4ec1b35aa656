#pragma once

#include <string>
#include <vector>

#include "identification/loop_record.hpp"

namespace polyfly {

/// A stretch in which the response moves at one rate while its command rests.
struct SteadyMove {
  TimeWindow window;
  double rate = 0.0;  ///< above 0 [unit of the response per s]
};

/// What flights show of a loop's rates.
struct LoopRates {
  std::vector<SteadyMove> moves;
  double fastest = 0.0;  ///< exceeded in 1 % of the samples
  /// Half width of the stretch over which each rate is measured [s].
  double half_stretch = 0.3;
};

/// One entry for each flight. A linear loop whose command rests never moves at one rate: the rate falls as the response
/// comes nearer. A loop that moves at one rate is at its limit. It must do so for more than half of the time in which it
/// moves by at least half of its greatest rate. A command that moves by half as much as the response in that time explains
/// the rate itself, and does not count. Nor do moves over less than a tenth of the response's range, or shorter than the
/// stretch over which rates are measured. That is the widest one by which the flights together support a greatest rate, or
/// else the widest of all. Segments of clean records.
std::vector<LoopRates> loopRates(const std::vector<std::vector<LoopSegment>>& flights);

/// The greatest rate of an inner loop.
struct GreatestRate {
  /// The moves that are at least 0.8 times as fast as the fastest one.
  std::vector<SteadyMove> moves;
  double value = 0.0;  ///< mean rate of the moves
  /// Half width of the 95 % interval of the mean, from the spread of the moves (Student's distribution).
  double half_width = 0.0;
  /// That of the flights' rates [s].
  double half_stretch = 0.3;
  /// Why the flight does not support the value; empty if it does.
  std::vector<std::string> reasons;

  bool supported() const { return reasons.empty(); }
};

/// Supported by three moves or more whose rates agree within 10 %, where the response is not faster elsewhere by 15 %.
/// `flights` has one entry for each flight.
GreatestRate greatestRate(const std::vector<LoopRates>& flights);

/// Where the response moves at this rate or faster, within 10 %, with the time over which rates are measured beside it.
std::vector<TimeWindow> stretchesAt(const GreatestRate& rate, const std::vector<LoopSegment>& segments);

}  // namespace polyfly
