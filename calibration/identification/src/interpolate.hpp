#pragma once

#include "identification/loop_record.hpp"

namespace polyfly {

/// The straight line between neighbouring samples; the first and last value beyond them. Not empty.
double interpolated(const TimeSeries& series, double time);

}  // namespace polyfly
