#pragma once

namespace polyfly {

/// Admissible values of an option, ends included. While commands are sent, it may become `factor` times as great or
/// small as what was in force, and `step` beyond that. See ChangeBounds.
struct Range {
  double least = 0.0;
  double greatest = 0.0;
  double factor = 10.0;
  double step = 0.0;  ///< [the option's unit]; above 0 where the option may be 0
};

/// Any admissible value at any time, of an option that may be as great as that.
constexpr Range anyChange(double least, double greatest) { return {least, greatest, 1.0, greatest - least}; }

/// An option of earlier versions, and what to use instead.
struct RemovedOption {
  const char* name;
  const char* instead;
};

}  // namespace polyfly
