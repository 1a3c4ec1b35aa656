#pragma once

#include <string>
#include <vector>

#include "identification/identify_axis.hpp"

namespace polyfly {

/// In words, what the data do not support or what is wrong with them.
std::vector<std::string> diagnose(const AxisModel& model, const AxisRecords& records,
                                  const FitOptions& bounds);

/// Whether a controller may be given these numbers: the model explains the response, the intervals of gain
/// and of the lag that counts the delay in exclude zero, and the gain is not one of another unit.
bool isSupported(const AxisModel& model);

}  // namespace polyfly
