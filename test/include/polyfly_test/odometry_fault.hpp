#pragma once

#include <Eigen/Core>

#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly {

/// What goes wrong with the odometry of a flight, and when. A start below zero means never.
struct FaultOptions {
  /// Time from which on the position is NaN [s].
  double nan_start = -1.0;
  /// Duration of the NaN position [s].
  double nan_time = 0.0;
  /// Time from which on nothing is published, while the clock continues [s].
  double silence_start = -1.0;
  /// Duration of the silence [s].
  double silence_time = 0.0;
  /// Time from which on the position is off by `jump` [s].
  double jump_start = -1.0;
  /// Duration of the jump [s].
  double jump_time = 0.0;
  /// Error of the position during the jump [m].
  Eigen::Vector3d jump = Eigen::Vector3d::Zero();
};

/// Lists the fields of FaultOptions once: visit(key, field, unit, range).
template <class Options, class Visitor>
void visitFaultOptions(Options& self, Visitor&& visit) {
  visit("nan_start", self.nan_start, "s", Range{-1.0, 1e6});
  visit("nan_time", self.nan_time, "s", Range{0.0, 1e6});
  visit("silence_start", self.silence_start, "s", Range{-1.0, 1e6});
  visit("silence_time", self.silence_time, "s", Range{0.0, 1e6});
  visit("jump_start", self.jump_start, "s", Range{-1.0, 1e6});
  visit("jump_time", self.jump_time, "s", Range{0.0, 1e6});
  visit("jump", self.jump, "m", Range{-1e6, 1e6});
}

/// Whether odometry is published `time` seconds after the start.
bool isSilent(const FaultOptions& faults, double time);

/// The odometry as the faults leave it `time` seconds after the start.
VehicleState applyFaults(const FaultOptions& faults, double time, const VehicleState& odometry);

}  // namespace polyfly
