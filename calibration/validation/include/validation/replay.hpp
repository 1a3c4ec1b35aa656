#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"
#include "validation/controller_options.hpp"
#include "validation/flight_log.hpp"

namespace polyfly {

class RegionMap;

/// Greatest difference of commands that counts as none, by default [rad, rad/s or m/s^2].
constexpr double kCommandTolerance = 1e-6;

/// Maps of the three axes: longitudinal, lateral, vertical. Not owned.
using AxisMaps = std::array<const RegionMap*, 3>;

/// The axis that a map serves, by its signals: 0 longitudinal, 1 lateral, 2 vertical. Throws Error naming the
/// map when it serves none.
std::size_t axisOf(const RegionMap& map);

/// Puts maps in the order of their axes by their signals. Throws Error naming the map or the axis when a map
/// fits no axis, two fit the same, or an axis has none.
AxisMaps assignAxes(const std::vector<const RegionMap*>& maps);

/// Why the replay does not know what the controller knew.
enum class Ignorance {
  kBegun,    ///< the recording begins in flight
  kMissing,  ///< a part of the recording is missing
  kAltered,  ///< the recorded odometry is not that which the controller answered
  kVersion,  ///< another version flew, whose estimators are not at hand
};

/// One control step of the replay.
struct ReplaySample {
  VehicleState state;
  bool has_reference = false;
  /// Reference at the time of the odometry. Valid with has_reference.
  Reference reference;
  /// Report that the controller computed again.
  ControlReport report;
  /// Why its command cannot be compared. Empty where it can.
  std::optional<Ignorance> ignorance;
  /// Whether the controller answered this position and velocity.
  bool is_known = true;
};

/// A flight with its replay. References: they must stay valid while it is judged.
struct ReplayedFlight {
  const FlightLog& log;
  const std::vector<ReplaySample>& samples;
  const MultirotorOptions& options;
};

/// Runs the controller of the nodelet over the log once more. One sample for each odometry message that the
/// recorded commands answer, in order: what the node never saw would spoil its observer here. Where no
/// command bears the stamp of any odometry, one for each. As in the node, maps look ahead only where their sampling time is
/// `preview_period` [s], see parsePreviewPeriod().
///
/// Behind a hole of the record, where it begins in flight, and at altered odometry the replay does not know what the
/// controller knew. It goes on from what was sent, and counts again once 50 commands in a row agree up to `tolerance`
/// [rad, rad/s, m/s^2]. Of a flight of another version the samples have the parameters, regions and statuses that were
/// recorded; no command of it can be compared. Throws Error when a map does not fit or an option is out of range.
std::vector<ReplaySample> replay(const FlightLog& log, const AxisMaps& maps, const MultirotorOptions& options,
                                 double preview_period = kPreviewPeriod,
                                 double tolerance = kCommandTolerance);

}  // namespace polyfly
