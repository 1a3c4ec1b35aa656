#pragma once

#include <vector>

#include "identification/identify_axis.hpp"

namespace polyfly {

// The stages of identifyAxis, in order. Several flights go through the second one together.

/// The clean record and the windows to fit to, `choice.windows`. Throws Error naming source, axis and rule where a signal
/// is empty or nothing is left of it.
AxisModel chooseWindows(const AxisRecords& records, const IdentifyOptions& options);

/// The greatest rate that all flights show together, as each one's. A linear model has none: what is flown at it is left
/// out of the windows of each flight. None may be null.
void leaveOutGreatestRate(const FitOptions& fit, const std::vector<AxisModel*>& flights);

/// Fits all models to the segments of the windows, validates and warns. The validation leaves out what the training does.
/// Throws Error naming source, axis and rule where there is nothing to fit to.
void fitAxis(const AxisRecords& records, const IdentifyOptions& options, AxisModel* model);

}  // namespace polyfly
