#pragma once

#include <string>

namespace polyfly {

/// Kind of the vehicle that flew, as the log or the user names it.
struct VehicleKind {
  /// multirotor, fixed_wing or unknown.
  std::string name = "unknown";
  /// How it is known, as a sentence.
  std::string reason = "Neither the log nor --vehicle names the kind of vehicle.";

  bool isKnown() const { return name != "unknown"; }
};

}  // namespace polyfly
