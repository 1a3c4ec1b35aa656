#pragma once

#include <vector>

#include "flight_grid.hpp"

namespace polyfly {

/// Signs of an upset at each time of a grid.
struct UpsetSigns {
  /// True: the attitude is beyond what was commanded, the vehicle turns beyond it, or the accelerometer shows free fall.
  std::vector<bool> upset;
  /// True: the accelerometer or the velocity shows an impact. Alone it is no upset.
  std::vector<bool> hit;
};

UpsetSigns upsetSigns(const FlightGrid& grid);

/// What all pieces of a flight say of its levels; needed to tell the ground in one of them.
struct FlightLevels {
  /// Throttle up to which it is at its least. NaN: throttle tells nothing.
  double throttle_least = 0.0;
  /// Airspeed up to which a fixed wing does not fly [m/s]. NaN: airspeed tells nothing.
  double airspeed_least = 0.0;
  /// Height up to which the vehicle may stand, and from which on it flies [m]. NaN: height tells nothing.
  double height_low = 0.0;
  double height_high = 0.0;
  /// Range of the specific force within a window up to which it rests [m/s^2]. NaN: it tells nothing.
  double force_rest = 0.0;
};

FlightLevels flightLevels(const std::vector<FlightGrid>& grids);

/// Signs of the ground at each time of a grid.
struct GroundSigns {
  std::vector<bool> stands;
  /// True: the attitude rests.
  std::vector<bool> rests;
};

GroundSigns groundSigns(const FlightGrid& grid, const FlightLevels& levels);

}  // namespace polyfly
