#pragma once

#include <vector>

#include "identification/identify_axis.hpp"

namespace polyfly {

/// One loop in one flight, and where to look for it.
struct AxisFlightRecords {
  AxisRecords records;
  /// Windows that are used as they are. Empty: chosen as in identifyAxis.
  std::vector<TimeWindow> windows;
};

/// One model of one axis from several flights of a vehicle. Each flight is identified on its own, and kept in `flights`.
/// The numbers are their means (meanParameters). The fit is that of the mean on the flight that it fits worst. Unless the
/// records bring one for validation, each flight is validated with the mean of the others: the least counts. A flight
/// without a usable stretch is left out with a warning. Of one flight the result is that of identifyAxis. Throws Error if
/// none is left.
AxisModel identifyFlights(const std::vector<AxisFlightRecords>& flights, const IdentifyOptions& options);

/// Means over flights of parameters with the same names in the same order. Half of an interval is the greatest of those
/// of the flights, and at least half the spread of the values. At least one flight.
std::vector<FittedParameter> meanParameters(const std::vector<std::vector<FittedParameter>>& flights);

}  // namespace polyfly
