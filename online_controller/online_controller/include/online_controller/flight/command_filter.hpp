#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "mpc_core/safety_filter.hpp"
#include "online_controller/laws/failsafe_policy.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// A command that follows another within this part of the maps' period is dropped: the other would be held for less
/// than the proof assumes.
constexpr double kLeastFilterPeriod = 0.5;

/// What the filter did. Worse ones have greater numbers; a step reports the worst of its axes.
enum class FilterStatus : std::uint8_t {
  /// The wish is safe, and was sent as it came.
  kPassed = 0,
  /// The nearest safe command was sent.
  kChanged = 1,
  /// There is no finite wish: a level attitude with hover thrust was filtered in its place.
  kNoWish = 2,
  /// No command keeps the state in the safe set: the one of least violation was sent.
  kOutside = 3,
  /// There is no finite state: the failsafe policy decided, and nothing was filtered.
  kNoState = 4,
};

struct FilterAxisReport {
  FilterStatus status = FilterStatus::kPassed;
  /// What the map looked up, without the wish: position [m] and velocity [m/s]. Where the map has them, also the
  /// measured acceleration and the input of the step before [m/s^2].
  std::array<double, 4> xi{};
  double wish = 0.0;   ///< [m/s^2]
  double input = 0.0;  ///< [m/s^2]
  LookupStatus lookup = LookupStatus::kNotFinite;
};

struct FilterReport {
  AttitudeCommand command;
  FilterStatus status = FilterStatus::kNoState;
  /// With kNoState: what was sent instead.
  ControlStatus fallback = ControlStatus::kOptimal;
  /// World x, y, z; those without a map pass.
  std::array<FilterAxisReport, 3> axes;
};

/// Safety filters (maps of type safety_filter) between a controller and the attitude controller. Position and
/// velocity stay in the maps' ranges (geofence, speed), acceleration in those of their inputs (tilt, thrust).
///
/// A command is taken as the acceleration that it makes at the measured yaw, R e3 T / m - g e3. Each axis is
/// filtered by its map, and the result turned back. A step without a change returns the wish bit for bit.
/// Commands must be one sampling time of the maps apart; the guarantee is that of their models.
class CommandFilter {
 public:
  /// Maps of one to three of the world's axes x, y, z: parameters p_x [m], v_x [m/s], perhaps a_x_before, and
  /// a_x_wish [m/s^2], input a_x [m/s^2]. Where the attitude lags behind its command, maps of x and y may have the
  /// acceleration as third state a_x, and then the input a_x_cmd. Throws Error for other maps, two of one axis, and
  /// different periods. Also where the vehicle's limits of thrust cannot make all accelerations in the ranges of the
  /// inputs.
  CommandFilter(std::vector<RegionMap> maps, const MultirotorOptions& options);

  /// The command for one period. Neither state nor wish needs to be finite.
  const FilterReport& step(const VehicleState& state, const AttitudeCommand& wish) noexcept;

  /// The period has no state: the failsafe policy answers.
  const FilterReport& stepWithoutState() noexcept;

  /// Sampling time of the maps [s].
  double period() const noexcept { return maps_[0].period(); }

  /// Problem of the map of the axis x, y or z (0, 1 or 2). Null where it has no map.
  const SafetyFilterProblem* problem(std::size_t axis) const noexcept {
    return axes_[axis].map < 0 ? nullptr : &axes_[axis].problem;
  }

 private:
  /// The map of one axis, with what its problem says.
  struct Axis {
    /// Index of the map; -1: none.
    int map = -1;
    /// Whether the acceleration is a state.
    bool lags = false;
    bool delayed = false;
    SafetyFilterProblem problem;
    /// The input of the last step.
    double before = 0.0;  ///< [m/s^2]
  };

  void bind(int map);
  void checkThrust() const;
  bool bindAxis(int map, std::size_t at, SafetyFilterProblem& problem);
  FilterAxisReport filter(Axis& axis, const std::array<double, 3>& state, double wish) const noexcept;
  AttitudeCommand commandOf(const Eigen::Vector3d& acceleration, double yaw, double yaw_rate) const noexcept;

  MultirotorOptions options_;
  std::vector<RegionMap> maps_;
  std::array<Axis, 3> axes_;
  FailsafePolicy failsafe_;
  /// That was sent last.
  double thrust_;  // [N]
  FilterReport report_;
};

/// The input in its range with the least violation of a safe set's admissible rows, in units of the rows of H. For
/// problems with one input. `xi` holds problem.augmentedCount() numbers. Allocates nothing.
double leastViolation(const SafetyFilterProblem& problem, const double* xi) noexcept;

}  // namespace polyfly
