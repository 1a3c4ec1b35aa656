#pragma once

#include <string>

#include "identification/loop_record.hpp"

namespace polyfly {

struct FlightSignals;

enum class VehicleKind {
  kUnknown,
  kMultirotor,
  kFixedWing,
};

/// Word of the calibration file: unknown, multirotor or fixed_wing.
const char* nameOf(VehicleKind kind);

/// The kind of that word. Throws Error.
VehicleKind vehicleKindOf(const std::string& name);

/// Kind of the vehicle that flew, and how it was recognised.
struct RecognisedVehicle {
  VehicleKind kind = VehicleKind::kUnknown;
  /// A sentence.
  std::string reason = "Nothing in the log tells the kind of vehicle.";
};

/// The kind that the log itself names, if FlightSignals::vehicle holds one. Else by the speed through the air, or
/// over ground where that is not known, between its first and last moment above kFastFlight:
/// - fixed wing: it stays above kStall for at least kLongFlight, and along the heading where yaw is known;
/// - multirotor: it falls below kStall for a tenth of that time, or never flies fast but moves.
/// A ground speed in strong wind can fall below kStall too. Unknown: none of these holds.
RecognisedVehicle recogniseVehicle(const FlightSignals& signals);

/// Speed that counts as fast flight [m/s].
constexpr double kFastFlight = 7.0;
/// Speed below which no fixed wing flies [m/s].
constexpr double kStall = 4.0;
/// Least length of the fast flight of a fixed wing [s].
constexpr double kLongFlight = 30.0;

}  // namespace polyfly
