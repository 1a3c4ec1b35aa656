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

/// One model of one axis from several flights of a vehicle. Each flight is identified on its own. The values
/// are the random-effects means over the flights, and their intervals hold the spread between flights
/// (poolFlights). Record, segments, pictures and warnings are those of all flights together on one clock:
/// the first begins at 0 s, the others follow with pauses. Unless `options` bring a record for validation,
/// each flight is validated with the model of the others. So are the models for a controller, which are judged
/// with these means and intervals. What is no flight is left out of each. A flight without a usable stretch
/// is left out with a warning. If one flight is left, the result is that of identifyAxis. Throws Error if none
/// is left.
AxisModel identifyFlights(const std::vector<AxisFlightRecords>& flights, const IdentifyOptions& options);

/// The mean over several flights of one model, with intervals that hold the spread between flights: values,
/// shape, gain and offset. All else is that of `fit`: the same model, with the same parameters. At least two
/// flights.
LoopFit poolFits(LoopFit fit, const std::vector<LoopFit>& flights);

/// Means over flights of parameters with the same names in the same order. At least two flights.
std::vector<FittedParameter> poolParameters(const std::vector<std::vector<FittedParameter>>& flights);

}  // namespace polyfly
