#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "polyfly_base/range.hpp"

namespace polyfly {

/// Keeps changes of options small while commands are sent: the thrust of the next command would follow any mass. The
/// new value must lie within the factor and the step of the option's Range. They count from the value that was in
/// force when the option last rested for kRest. So many small changes in a row go no further than one. Reads no
/// clock; time is an argument [s].
class ChangeBounds {
 public:
  /// Time without a change after which an option rests.
  static constexpr double kRest = 10.0;  ///< [s]

  struct Option {
    std::string name;
    std::string unit;
    Range range;
  };

  /// `values`, one of each option, are in force.
  ChangeBounds(std::vector<Option> options, const std::vector<double>& values);

  /// Throws Error naming the first option of `wanted` that is too far from what was in force, and how far it
  /// may go.
  void check(const std::vector<double>& wanted, double now) const;

  /// `values` are in force from `now` on.
  void change(const std::vector<double>& values, double now);

  /// `values` are in force, and what was before does not count: no commands are sent.
  void settle(const std::vector<double>& values);

 private:
  struct Past {
    // Value from which changes count.
    double base = 0.0;
    // Value in force.
    double value = 0.0;
    // Whether the value changed since it was settled. Only then `last_change` is valid.
    bool changed = false;
    double last_change = 0.0;
  };

  static double base(const Past& past, double now) noexcept;

  std::vector<Option> options_;
  std::vector<Past> past_;
};

}  // namespace polyfly
