#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "fixedwing_lateral/air_data.hpp"
#include "fixedwing_lateral/guidance_options.hpp"
#include "fixedwing_lateral/lateral_nmpc.hpp"
#include "fixedwing_lateral/lateral_observer.hpp"
#include "fixedwing_lateral/mission.hpp"
#include "fixedwing_lateral/reversal.hpp"

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
  double time = 0.0;  ///< now [s]
  AircraftState state;
  StampedAirspeed airspeed;  ///< [m/s]
  StampedWind wind;          ///< where the air moves to (north, east) [m/s]
  bool engaged = true;       ///< the autopilot follows our commands
};

/// Where the command comes from, from best to worst.
enum class GuidanceMode : std::uint8_t {
  kTracking,     ///< the present horizon
  kHoldHorizon,  ///< a horizon of an earlier call, further on in it
  kUpwind,       ///< a turn into the wind
  kLevel,        ///< wings level
  kStandby,      ///< not engaged: the roll that is flown
};

/// Why it is not plain tracking; the first that holds.
enum class GuidanceReason : std::uint8_t {
  kNone,
  kNotEngaged,
  kNoMission,
  kNotFinite,  ///< a NaN, an infinity, roll of 80 degrees or 20 rad/s and more
  kStale,      ///< the state is too old, from the future, or repeats itself under new stamps
  kJump,       ///< position, heading or roll is not where it was expected
  kSolver,     ///< the optimisation failed, also after beginning anew
  kLowAirspeed,
  kStrongWind,
  kAirspeedAssumed,  ///< tracks, with the nominal airspeed
  kWindAssumed,      ///< tracks, with the wind that ground and air velocity differ by
  kTooSteep,  ///< tracks a segment that asks for more roll in this wind than is allowed, and leaves it there
};

const char* toString(GuidanceMode mode) noexcept;
const char* toString(GuidanceReason reason) noexcept;

struct GuidanceOutput {
  GuidanceMode mode = GuidanceMode::kLevel;
  GuidanceReason reason = GuidanceReason::kNoMission;
  double roll_reference = 0.0;  ///< always finite and within the limit [rad]
  int segment = 0;              ///< index in the mission
  int segment_count = 0;
  bool loitering = false;
  TrackError error;  ///< to the current segment, at the state
  /// Greatest roll that the current segment needs in this wind, see turn_limits.hpp [rad].
  double segment_roll = 0.0;
  double airspeed = 0.0;  ///< as flown by [m/s]
  Eigen::Vector2d wind = Eigen::Vector2d::Zero();
  double roll_bias = 0.0;  ///< as learnt, see LateralObserver [rad]
  double turn_gain = 1.0;
  double turn_bias = 0.0;  ///< [rad/s]
  NmpcReport nmpc;
  bool restarted = false;  ///< the horizon began anew in this call
};

/// The fixed wing's lateral guidance: mission, optimisation and what to do when something is missing.
///
///     output = guidance.update(input);   // as soon as the state is in: feedback
///     while (thereIsTime() && guidance.improve()) {}   // by choice: until it has converged
///     guidance.prepare();                // when the command is out: preparation of the next call
///
/// `update`, `improve` and `prepare` do not allocate, throw, log or read a clock. One object serves one
/// thread.
class LateralGuidance {
 public:
  /// Throws polyfly::Error, beginning with `where`.
  LateralGuidance(const GuidanceOptions& options, const std::string& where);

  /// Begins the mission at its first segment. Allocates.
  void setMission(Mission mission);
  void clearMission();

  /// Weights, limits and safety; they must pass checkGuidance. Nothing is allocated.
  void setTuning(const LateralWeights& weights, const LateralLimits& limits,
                 const SafetyOptions& safety) noexcept;

  const GuidanceOutput& update(const GuidanceInput& input) noexcept;

  /// One more iteration from the state of the last `update`, which may change the output. False, and nothing
  /// is changed, where there is nothing to gain: KKT is below the tolerance, or it is not tracking. Reads no
  /// clock: the caller decides between two iterations whether there is time for another.
  bool improve() noexcept;
  void prepare() noexcept;

  const GuidanceOutput& output() const noexcept { return output_; }  ///< of the last call
  const GuidanceOptions& options() const noexcept { return options_; }
  const MissionTrack& track() const noexcept { return track_; }
  const LateralNmpc& nmpc() const noexcept { return nmpc_; }  ///< for the predicted path

 private:
  GuidanceReason fault(const GuidanceInput& input) noexcept;
  bool repeats(const AircraftState& state) noexcept;
  bool hasTurned(const AircraftState& state, double elapsed) const noexcept;
  bool hasJumped(const AircraftState& state) noexcept;
  bool solve(const GuidanceInput& input) noexcept;
  LateralState predicted(const AircraftState& state) const noexcept;
  void learn(const GuidanceInput& input) noexcept;
  void fillData() noexcept;
  void restart(const LateralState& state) noexcept;
  void keepHorizon(double time) noexcept;
  void holdOrLevel(double time) noexcept;
  LateralConditions presentConditions() const noexcept;
  void beginSegment(Reversal reversal) noexcept;
  void chooseReversal(const AircraftState& state) noexcept;
  void checkSegment(const AircraftState& state) noexcept;
  double upwindReference(double heading) const noexcept;
  void command(GuidanceMode mode, GuidanceReason reason, double roll_reference) noexcept;

  GuidanceOptions options_;
  MissionTrack track_;
  ReversalChoice reversal_;
  Junction junction_;  // at the end of the current segment
  AirData air_;
  LateralObserver observer_;
  LateralNmpc nmpc_;
  HorizonData data_;
  GuidanceOutput output_;
  LateralState solved_from_ = LateralState::Zero();  // of the last optimisation
  bool can_improve_ = false;
  std::vector<double> kept_moves_;  // of the last horizon that was good
  bool prepared_ = false;           // for data_ as it is
  bool too_steep_ = false;          // the current segment, in this wind
  bool needs_restart_ = true;       // the nodes are of another flight
  double horizon_time_ = -1e300;    // of the last horizon that was good [s]
  bool has_place_ = false;
  AircraftState place_;  // the last one believed
  AircraftState seen_;   // the first one at its position
  double jump_since_ = 0.0;
  bool jumping_ = false;
};

}  // namespace polyfly
