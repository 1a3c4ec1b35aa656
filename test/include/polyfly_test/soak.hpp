#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "nonlinear_mpc/nonlinear_mpc.hpp"
#include "online_controller/laws/law_switch.hpp"
#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller/types/options.hpp"

namespace polyfly {
class RegionMap;
}

namespace polyfly_test {

/// What laws are made from: maps of the three axes, and the problems of the linear law.
struct SoakLaws {
  std::vector<std::array<const polyfly::RegionMap*, 3>> maps;  ///< sets to be swapped, at least one
  std::array<polyfly::MpcProblem, 3> problems;
  /// Maps of the robust law, as many sets; none: it does not fly.
  std::vector<std::array<const polyfly::RegionMap*, 3>> robust_maps = {};
};

struct SoakOptions {
  /// Simulated duration [s].
  double duration = 1800.0;
  /// Seed of the flight. The same seed gives the same flight.
  std::uint32_t seed = 1;
  /// Names of the laws that are selected.
  std::vector<std::string> laws = {"explicit_linear", "linear", "nonlinear"};
};

struct SoakResult {
  long samples = 0, silences = 0, not_numbers = 0, jumps = 0, out_of_order = 0, wrong_frames = 0, huge = 0;
  long reconfigurations = 0, swaps = 0, selections = 0, references = 0;
  /// Commands that were sent.
  long commands = 0;
  /// Samples without an answer of the law.
  long failsafe = 0;
  /// Faults after which the vehicle was back on its path before the next fault.
  long recoveries = 0;
  /// Slowest recovery [s].
  double slowest = 0.0;
  /// Greatest position error before the next fault [m].
  double greatest_error = 0.0;
  /// Bytes in use at the end, less those after the first tenth.
  long allocated_growth = 0;
  /// Sentences on sent commands beyond a bound, and on faults without a recovery.
  std::vector<std::string> violations;
};

/// Weights, limits and gains.
struct SoakTuning {
  polyfly::MultirotorOptions options;
  polyfly::NonlinearMpcOptions nonlinear;
  polyfly::LinearTuning linear;
};

/// What became of a control period.
struct SoakAnswer {
  /// Whether a command was sent.
  bool sends = false;
  /// Command that was sent.
  polyfly::AttitudeCommand command;
  polyfly::ControlStatus status = polyfly::ControlStatus::kStopped;
  /// Limits in force when the command was made.
  polyfly::MultirotorOptions limits;
};

/// The controller under test: its core, or the node around it. Axes as everywhere.
class SoakController {
 public:
  virtual ~SoakController() = default;

  /// One control period with odometry, `frame_fits` or in another frame than the others.
  virtual SoakAnswer onOdometry(const polyfly::VehicleState& state, bool frame_fits) = 0;
  /// One without, at time `now` [s]; silence has lasted for `periods`.
  virtual SoakAnswer onSilence(double now, int periods) = 0;
  /// A trajectory of points `period` seconds apart, from time `start` on [s].
  virtual void setReference(const std::vector<polyfly::Reference>& points, double period, double start) = 0;

  virtual void reconfigure(const SoakTuning& tuning) = 0;
  virtual void swapMaps(std::size_t set) = 0;  ///< one of SoakLaws::maps
  virtual void select(polyfly::Law law) = 0;
};

/// Flies `controller` in simulated time and lets everything go wrong at random. Odometry falls silent, jumps, is not
/// a number or huge, comes in the wrong order or frame. Options, maps (one of `map_sets`) and laws change. `tuning`
/// is what the controller was made with. `progress` is told the simulated time now and then.
SoakResult soak(SoakController& controller, const SoakTuning& tuning, int map_sets,
                const SoakOptions& options, const std::function<void(double)>& progress = {});

/// The same of the controller's core, which exchanges laws as the node does.
SoakResult soak(const SoakLaws& laws, const SoakOptions& options,
                const std::function<void(double)>& progress = {});

}  // namespace polyfly_test
