#pragma once

#include <vector>

namespace polyfly {

/// What one flight says of a parameter.
struct FlightValue {
  double value = 0.0;
  /// Standard error within the flight. NaN: the flight's data do not bound the value.
  double standard_error = 0.0;
};

/// The mean over the flights that a vehicle could fly, from those that it flew.
struct PooledValue {
  double value = 0.0;
  /// Standard error of the mean, with the spread between flights.
  double standard_error = 0.0;
  /// Half width of the 95 % confidence interval.
  double half_width = 0.0;
  /// Standard deviation between flights, without what the errors within the flights explain.
  double between_flights = 0.0;
};

/// Random-effects mean: each flight has a value of its own, drawn about that of the vehicle. The variance
/// between flights is that of Paule and Mandel (J. Res. Nat. Bur. Stand. 87, 1982), never negative. The
/// interval takes Student's factor for one degree of freedom fewer than flights (Hartung and Knapp,
/// Stat. Med. 20, 2001; with this variance their scale is 1), and is never narrower than without spread.
/// An error that is NaN counts as the greatest of the others. At least two flights; finite values.
PooledValue poolFlights(const std::vector<FlightValue>& flights);

/// The factor of a 95 % interval for so many degrees of freedom, at least 1 (Student's distribution).
double studentFactor(int degrees);

}  // namespace polyfly
