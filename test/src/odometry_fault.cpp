#include "polyfly_test/odometry_fault.hpp"

#include <limits>

namespace polyfly {
namespace {

bool within(double time, double start, double length) {
  return start >= 0.0 && time >= start && time < start + length;
}

}  // namespace

bool isSilent(const FaultOptions& faults, double time) {
  return within(time, faults.silence_start, faults.silence_time);
}

VehicleState applyFaults(const FaultOptions& faults, double time, const VehicleState& odometry) {
  VehicleState changed = odometry;
  if (within(time, faults.jump_start, faults.jump_time)) {
    changed.position += faults.jump;
  }
  if (within(time, faults.nan_start, faults.nan_time)) {
    changed.position.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return changed;
}

}  // namespace polyfly
