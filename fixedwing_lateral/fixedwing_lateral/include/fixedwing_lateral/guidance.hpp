#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "fixedwing_lateral/air_data.hpp"
#include "fixedwing_lateral/convergence.hpp"
#include "fixedwing_lateral/guidance_options.hpp"
#include "fixedwing_lateral/lateral_nmpc.hpp"
#include "fixedwing_lateral/lateral_observer.hpp"
#include "fixedwing_lateral/mission.hpp"
#include "fixedwing_lateral/reversal.hpp"
#include "fixedwing_lateral/speed_scaling.hpp"

namespace polyfly {

/// What is known of the aircraft. North-east, right-handed down: roll to the right is positive.
struct AircraftState {
  double stamp = 0.0;                                         ///< [s]
  Eigen::Vector2d position = Eigen::Vector2d::Zero();         ///< (north, east) [m]
  Eigen::Vector2d ground_velocity = Eigen::Vector2d::Zero();  ///< (north, east) [m/s]
  double heading = 0.0;                                       ///< psi [rad]
  double roll = 0.0;                                          ///< phi [rad]
  double roll_rate = 0.0;                                     ///< p [rad/s]
};

struct GuidanceInput {
  /// Present time [s].
  double time = 0.0;
  AircraftState state;
  StampedAirspeed airspeed;  ///< [m/s]
  /// Velocity of the air over ground (north, east) [m/s].
  StampedWind wind;
  /// True while the autopilot follows our commands.
  bool engaged = true;
};

/// Where the command comes from. The numbers are those of LateralStatus.
enum class GuidanceMode : std::uint8_t {
  /// Command of the present horizon.
  kTracking,
  /// Command of an earlier horizon, at the time that has passed since.
  kHoldHorizon,
  /// Turn into the wind.
  kUpwind,
  /// Wings level.
  kLevel,
  /// Not engaged: the command is the present roll.
  kStandby,
  /// L1 guidance, because the optimisation does not lead to the path.
  kFallback,
};

/// Why it is not plain tracking; the first that holds.
enum class GuidanceReason : std::uint8_t {
  kNone,
  kNotEngaged,
  kNoMission,
  /// A value is NaN or infinite, roll is 80 degrees or more, or roll rate 20 rad/s or more.
  kNotFinite,
  /// The state is too old, is from the future, or repeats itself under new stamps.
  kStale,
  /// Position, heading or roll differs too much from the expected one.
  kJump,
  /// The optimisation failed, also after a restart.
  kSolver,
  kLowAirspeed,
  kStrongWind,
  /// Tracking with the nominal airspeed.
  kAirspeedAssumed,
  /// Tracking with a wind that is the difference of ground and air velocity.
  kWindAssumed,
  /// Tracking a segment that needs more roll in this wind than is allowed. The aircraft leaves the path there.
  kTooSteep,
  /// The optimisation did not lead to the path, see ConvergenceWatch. L1 guidance flies until it has been on the path
  /// for a while, and longer with each time.
  kNotConverging,
};

const char* toString(GuidanceMode mode) noexcept;
const char* toString(GuidanceReason reason) noexcept;

struct GuidanceOutput {
  GuidanceMode mode = GuidanceMode::kLevel;
  GuidanceReason reason = GuidanceReason::kNoMission;
  /// Roll command, always finite and within the limit [rad].
  double roll_reference = 0.0;
  /// Index of the current segment in the mission.
  int segment = 0;
  int segment_count = 0;
  bool loitering = false;
  /// Cross-track and course error from the current segment, at the measured state.
  TrackError error;
  /// Greatest roll that the current segment needs in this wind, see turn_limits.hpp [rad].
  double segment_roll = 0.0;
  /// Airspeed in use, measured or nominal [m/s].
  double airspeed = 0.0;
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();
  /// Learnt roll bias, see LateralObserver [rad].
  double roll_bias = 0.0;
  double turn_gain = 1.0;
  double turn_bias = 0.0;  ///< [rad/s]
  NmpcReport nmpc;
  /// True when the horizon was restarted in this call.
  bool restarted = false;
};

/// The fixed wing's lateral guidance: mission, optimisation and what to do when something is missing.
///
///     // Feedback, as soon as the state has arrived.
///     output = guidance.update(input);
///     // Preparation of the next call, after the command was sent.
///     guidance.prepare();
///
/// `update` and `prepare` do not allocate, throw, log or read a clock. One object serves one
/// thread.
class LateralGuidance {
 public:
  /// Throws polyfly::Error, beginning with `where`.
  LateralGuidance(const GuidanceOptions& options, const std::string& where);

  /// Begins the mission at its first segment. Allocates.
  void setMission(Mission mission);
  void clearMission();

  /// Weights but their airspeed, limits and safety; they must pass checkGuidance. Nothing is allocated.
  void setTuning(const LateralWeights& weights, const LateralLimits& limits,
                 const SafetyOptions& safety) noexcept;

  const GuidanceOutput& update(const GuidanceInput& input) noexcept;

  void prepare() noexcept;

  /// Output of the last call.
  const GuidanceOutput& output() const noexcept { return output_; }
  const GuidanceOptions& options() const noexcept { return options_; }
  const MissionTrack& track() const noexcept { return track_; }
  /// The optimiser; it holds the predicted path.
  const LateralNmpc& nmpc() const noexcept { return nmpc_; }

 private:
  GuidanceReason fault(const GuidanceInput& input) noexcept;
  bool repeats(const AircraftState& state) noexcept;
  bool hasTurned(const AircraftState& state, double elapsed) const noexcept;
  bool hasJumped(const AircraftState& state) noexcept;
  bool solve(const GuidanceInput& input) noexcept;
  void learn(const GuidanceInput& input) noexcept;
  void fillData() noexcept;
  void shapeCorner() noexcept;
  void setWeights() noexcept;
  void trustOptimisation() noexcept;
  void restart(const LateralState& state) noexcept;
  void keepHorizon(double time) noexcept;
  void holdOrLevel(double time) noexcept;
  LateralConditions presentConditions() const noexcept;
  void beginSegment() noexcept;
  void chooseReversal(const AircraftState& state) noexcept;
  void checkSegment(const AircraftState& state) noexcept;
  void watchConvergence(const AircraftState& state, double elapsed) noexcept;
  double fallbackReference(const AircraftState& state) const noexcept;
  double upwindReference(double heading) const noexcept;
  void command(GuidanceMode mode, GuidanceReason reason, double roll_reference) noexcept;

  GuidanceOptions options_;
  MissionTrack track_;
  ReversalChoice reversal_;
  AirData air_;
  LateralObserver observer_;
  SpeedScaling scaling_;
  // Time of the last call with a valid state [s].
  double last_time_ = -1e300;
  LateralNmpc nmpc_;
  HorizonData data_;
  GuidanceOutput output_;
  // Moves of the last valid horizon.
  std::vector<double> kept_moves_;
  // True when the quadratic program is prepared for the present data_.
  bool prepared_ = false;
  // True when the current segment needs more roll in this wind than is allowed.
  bool too_steep_ = false;
  ConvergenceWatch convergence_;
  // True while L1 guidance flies.
  bool falls_back_ = false;
  // For how long L1 guidance must be on the path before the optimisation flies again, in time limits of convergence;
  // doubles each time.
  double probation_ = 1.0;
  // True when the nodes are no longer valid, because they belong to another flight.
  bool needs_restart_ = true;
  // Time of the last valid horizon [s].
  double horizon_time_ = -1e300;
  bool has_place_ = false;
  // Last state that passed the jump check.
  AircraftState place_;
  // First state received at the present position.
  AircraftState seen_;
  double jump_since_ = 0.0;
  bool jumping_ = false;
};

}  // namespace polyfly
