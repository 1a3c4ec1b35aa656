#pragma once

#include <vector>

#include "identification/identify_axis.hpp"

namespace polyfly {

// The stages of identifyAxis, in order.

/// The clean record and the windows to fit to, `choice.windows`. Throws Error naming source, axis and rule where a signal
/// is empty or nothing is left of it.
AxisModel chooseWindows(const AxisRecords& records, const IdentifyOptions& options);

/// Fits all models to the segments of the windows, validates and warns. Throws Error naming source, axis and rule where there is nothing to fit to.
void fitAxis(const AxisRecords& records, const IdentifyOptions& options, AxisModel* model);

}  // namespace polyfly
