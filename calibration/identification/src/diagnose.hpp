#pragma once

#include <string>
#include <vector>

#include "identification/identify_axis.hpp"

namespace polyfly {

/// In words, what the data do not support or what is wrong with them.
std::vector<std::string> diagnose(const AxisModel& model, const AxisRecords& records,
                                  const FitOptions& bounds);

/// Sets the reasons against each controller model, and whether the one that problem files take is supported.
/// `bounds` are those of the fit.
void judgeModels(const FitOptions& bounds, AxisModel* model);

}  // namespace polyfly
