#pragma once

#include <vector>

#include "identification/motion.hpp"

namespace polyfly {

/// From the first to the last sample, on the flight's own clock [s]; from infinity to minus infinity without one.
TimeWindow spanOf(const FlightSignals& flight);

/// Goes on with the next piece of a recording. Its units must have been found as those of the piece before.
void append(FlightSignals piece, FlightSignals* recording);

/// Several flights on one clock: the first begins at 0 s, the others follow with pauses. Holds the signals
/// and the places that all of them have, and the stretches of each that are no flight. Throws Error if the thrust commands are of different units. At least one flight.
struct JoinedFlights {
  FlightSignals signals;
  /// From each flight's own time to the common one [s].
  std::vector<double> shifts;
  /// From the first to the last sample of each flight, on the common clock [s].
  std::vector<TimeWindow> spans;
};
JoinedFlights joinFlights(const std::vector<FlightSignals>& flights);

/// A model from several flights, with the parameters of each.
struct SeveralFit : MotionFit {
  std::vector<std::vector<FittedParameter>> flights;
};

/// fitDrag of all flights together (`joint`), with the random-effects means over the flights as parameters:
/// their intervals hold the spread between flights (poolFlights). Each flight must have the axes of `joint`;
/// throws Error otherwise. At least two flights.
SeveralFit fitDragOf(const Motion& joint, const std::vector<Motion>& flights);

/// fitMass, likewise.
SeveralFit fitMassOf(const Motion& joint, const std::vector<Motion>& flights, const MotionOptions& options);

}  // namespace polyfly
