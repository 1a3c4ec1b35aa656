#pragma once

#include <vector>

#include "identification/loop_record.hpp"

namespace polyfly {

/// The step in which the logged commands were rounded, or 0 if they are not on a grid: the greatest number of
/// which all values are multiples, if there are enough values, and enough steps in their range, to tell.
double commandQuantum(const std::vector<LoopSegment>& segments);

/// Variance that rounding to this step brings into a gain, as a share of the gain squared: each level of the
/// command carries one error, uniform over a step, for as long as it is held.
double gainVarianceOfRounding(const std::vector<LoopSegment>& segments, double quantum);

}  // namespace polyfly
