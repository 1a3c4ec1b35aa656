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

/// Time by which the response leads its command [s]; 0 where it does not. A lead shows where a fit with `bounds` found no
/// delay, and one that may be negative is better.
double leadOf(const LoopFit& with_delay, const std::vector<LoopSegment>& segments, FitOptions bounds);

std::string leadSentence(double lead);

}  // namespace polyfly
