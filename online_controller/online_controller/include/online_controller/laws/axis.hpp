#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "mpc_core/coefficient_estimate.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/observer.hpp"
#include "online_controller/laws/axis_law.hpp"
#include "online_controller/laws/stage_references.hpp"
#include "online_controller/types/options.hpp"
#include "online_controller/types/types.hpp"
#include "online_controller/types/vehicle_model.hpp"
#include "region_maps/lookup.hpp"

namespace polyfly {

class RegionMap;

/// Signals that a map must have to serve an axis, by name. One that bounds states themselves has the references of
/// these states too. The map of a minimum-peak robust MPC has the errors, and may have the references of velocity and
/// input. Without that of the input it is for a target that needs none.
struct AxisNames {
  const char* axis;
  const char* position_error;
  const char* velocity_error;
  const char* angle_error;  ///< nullptr: the input is an acceleration, there is no lag state
  const char* previous_input;
  const char* input_reference;
  const char* input;
  const char* input_unit;
  const char* velocity_reference;
  const char* position_reference;
  const char* angle_reference;   ///< nullptr where there is no lag state
  const char* angle_rate_error;  ///< of models whose attitude loop is of second order; nullptr as above
  /// With it a map looks ahead, see Axis::aim.
  const char* disturbance_ahead;
};

constexpr std::array<AxisNames, 3> kAxisNames{{
    {"longitudinal", "e_p_x", "e_v_x", "e_theta", "theta_cmd_prev", "theta_cmd_ref", "theta_cmd", "rad",
     "v_x_ref", "p_x_ref", "theta_ref", "e_theta_rate", "d_x_ahead"},
    {"lateral", "e_p_y", "e_v_y", "e_phi", "phi_cmd_prev", "phi_cmd_ref", "phi_cmd", "rad", "v_y_ref",
     "p_y_ref", "phi_ref", "e_phi_rate", "d_y_ahead"},
    {"vertical", "e_p_z", "e_v_z", nullptr, "T_cmd_prev", "T_cmd_ref", "T_cmd", "m/s^2", "v_z_ref", "p_z_ref",
     nullptr, nullptr, "d_z_ahead"},
}};

/// What is measured of one axis, in the world-aligned frame.
struct AxisSample {
  double position = 0.0;  ///< [m]
  double velocity = 0.0;  ///< [m/s]
  double angle = 0.0;     ///< specific force that accelerates the axis over g [rad]; 0 for the vertical
  double rate = 0.0;      ///< derivative of `angle` under constant thrust [rad/s]
};

/// What the axis shall do, with the derivatives that the model needs to follow it without lag.
struct AxisReference {
  double position = 0.0;      ///< [m]
  double velocity = 0.0;      ///< [m/s]
  double acceleration = 0.0;  ///< [m/s^2]
  double jerk = 0.0;          ///< [m/s^3]
  /// Known disturbance, in addition to the observer's estimate [m/s^2].
  double disturbance = 0.0;
};

/// What the parameters of an axis' law may be.
enum class AxisEntry : std::size_t {
  kPositionError,
  kVelocityError,
  kAngleError,
  kPreviousInput,
  kInputReference,
  kVelocityReference,
  kPositionReference,
  kAngleReference,
  kAngleRateError,
  kDisturbanceAhead,
};

/// Whether the entry is measured, and not a reference or what was sent.
inline bool isError(AxisEntry entry) noexcept {
  return entry == AxisEntry::kPositionError || entry == AxisEntry::kVelocityError ||
         entry == AxisEntry::kAngleError || entry == AxisEntry::kAngleRateError;
}

/// A value for each AxisEntry, from which the parameters are assembled in the law's order.
class AxisValues {
 public:
  double& operator[](AxisEntry entry) noexcept { return values_[static_cast<std::size_t>(entry)]; }
  double operator[](AxisEntry entry) const noexcept { return values_[static_cast<std::size_t>(entry)]; }

 private:
  std::array<double, 10> values_{};
};

/// State and input that follow a reference exactly under a constant disturbance, as long as no bound is
/// active.
struct AxisTarget {
  double angle = 0.0;  ///< [rad]
  double input = 0.0;  ///< u_ref, not limited [rad or m/s^2]
  double rate = 0.0;   ///< derivative of `angle` [rad/s]
};

/// One axis of the linear controllers: signals bound by name, observer, target, law.
///
/// The axis is a chain p' = v, v' = -drag v + G s + B_d d. Here s is the input itself (vertical) or a tilt angle that
/// follows the input. A lag of first order is s' = a s + b u. One of second order is s'' = a s + c s' + b u, where
/// the error of s' is a parameter. The numbers are read off the law's problem.
class Axis {
 public:
  /// Throws Error naming the map or problem, the signal or field, and the rule.
  Axis(std::unique_ptr<AxisLaw> law, const AxisNames& names, const MultirotorOptions& options);

  /// Keeps a reference to `map`. Throws Error.
  Axis(const RegionMap& map, const AxisNames& names, const MultirotorOptions& options);

  /// Eq. 6 in the frame that moves with the reference. There e = x - x_ref obeys the model with the equivalent
  /// disturbance B_d d_eq = B_d d - drag v_ref - a_ref. Its steady state is (s_ref, u_ref). When a_ref or d changes,
  /// s_ref does, and the lag is led: u_ref = (steady input) + s_ref' / b. With this the acceleration feed-forward of
  /// Eq. 41 is part of u_ref, hence of what the map's constraints limit. A lag of second order has u_ref = -(a s_ref
  /// + c s_ref') / b: the second derivative of a_ref is not known.
  AxisTarget target(const AxisReference& reference, double disturbance,
                    double disturbance_rate) const noexcept;

  /// Lets the observer take the sample, `periods` control periods after the last one, during which
  /// `applied_input` was held. The drag is learnt from the `followed` velocity, that of the reference then; without
  /// one it is forgotten [m/s].
  void observe(const AxisSample& sample, double applied_input, int periods,
               std::optional<double> followed = 0.0) noexcept;

  void reset() noexcept;
  /// Sets the observer's estimate [m/s^2] and forgets the drag that was found.
  void setDisturbance(double disturbance) noexcept;

  /// Goes on with the observer of another axis of the same model; one whose states stand in another order
  /// is ignored.
  void transferState(const Axis& other) noexcept;

  /// Of the last evaluate(), see ControlLaw::kktResidual.
  double kktResidual() const noexcept { return law_->kktResidual(); }

  /// The axis in error coordinates, one stage after the other. It is open loop along the plan of an online law, and
  /// closed loop through the map of an explicit one.
  struct Prediction {
    int stage = 0;
    /// Errors and references at the beginning of the stage.
    AxisValues values;
    /// Input u over the stage [rad or m/s^2].
    double input = 0.0;
    /// True where an online law planned the input.
    bool planned = false;
  };
  Prediction beginPrediction(const AxisReport& report) const noexcept;
  void advance(Prediction& at) const noexcept;
  double stagePeriod() const noexcept { return stage_period_; }  ///< [s]

  /// Number of stages that can have references of their own (look-ahead); 0: none, as with a map that has no parameter for
  /// them.
  int stages() const noexcept { return stage_references_ ? stage_references_->horizon() : 0; }

  /// Reference of stage 0 .. stages() for aim(), where stages() is above 0. Its disturbance is not read: a constant one is
  /// held by the targets.
  void setStage(int stage, const AxisReference& reference) noexcept {
    stage_references_->set(stage, reference.position, reference.velocity, reference.acceleration,
                           reference.jerk);
  }

  /// Whether the numbers of setStage are finite and within what isValidNumber() allows.
  bool areStagesValid() const noexcept;

  /// Whether the next evaluations look ahead to the references of setStage, or take theirs for that of all stages.
  ///
  /// A law that is solved online takes the reference of each stage. A map has a parameter for a short model of the
  /// references ahead. It is a disturbance of the error that stays constant over the horizon. A reference whose
  /// velocity changes evenly, and is not told in advance, has such a one. For other references the disturbance is
  /// taken that changes the input as much where no bound is active. It is clipped to the parameter's range: beyond it
  /// the map looks ahead less.
  void aim(bool look_ahead) noexcept;

  /// Position of the reference at a stage, from where the first stage's reference would have led [m]; 0 without
  /// look-ahead.
  double shift(int stage) const noexcept;

  /// The short model's disturbance of the last aim() [m/s^2]; 0 where a map looks ahead with none, and for online laws.
  double disturbanceAhead() const noexcept { return disturbance_ahead_; }

  /// Assembles the parameters, evaluates the law and fills the report. Without an answer (kHoldLast) the report's input
  /// is left alone. Where a map has no answer:
  /// - its problem is solved online: kOptimal with a look-up that is not kInside;
  /// - with options.solve_outside unset, the parameters are clipped to the map's box: kClipped;
  /// - a minimum-peak robust MPC without a plan that meets all bounds (the disturbance was beyond its range) answers with its
  ///   errors shrunk: the greatest share of the clipped errors that has a plan (of all parameters, where no share does):
  ///   kLeastViolation.
  ///
  /// `input_offset` is added to u_ref and `previous_input`, and the report's input has it. Then the bounds, and
  /// nothing else, are those of the model's input with the offset.
  ControlStatus evaluate(const AxisSample& sample, const AxisReference& reference, double previous_input,
                         double input_offset, AxisReport& report) noexcept;

  /// The input that follows the reference without error, not limited; 0 where the law is not told of it.
  double inputReference(const AxisReference& reference) const noexcept { return goalOf(reference).input; }

  /// The estimate that the targets remove [m/s^2]: the observer's, or 0 with options.offset_free unset. For a minimum-peak
  /// robust MPC it is the constant part alone, the observer's estimate behind a lag of options.robust_estimate_time. That
  /// law accounts for all that varies, so compensating it would count it twice.
  double disturbance() const noexcept {
    if (law_->problem().minimum_peak) return removes_constant_ ? constant_part_ : 0.0;
    return offset_free_ ? observer_.disturbance() : 0.0;
  }
  /// Constant part of the disturbance that a minimum-peak robust MPC does not remove [m/s^2]; 0 where that is at most a third
  /// of the range that its problem was made for.
  double constantLeft() const noexcept;
  /// The same with the drag that was found, at the reference's velocity [m/s^2].
  double disturbanceAt(const AxisReference& reference) const noexcept {
    return disturbance() - dragCoefficient() * reference.velocity;
  }
  /// What the reference needs, of the last evaluate().
  const AxisTarget& goal() const noexcept { return goal_; }
  /// The part of it that no disturbance asks for: acceleration and drag, also the drag that was found.
  AxisTarget undisturbedGoal(const AxisReference& reference) const noexcept;
  const MpcProblem& problem() const noexcept { return law_->problem(); }

  /// Of the lag: its steady gain -b / a [1], and its time -1 / a or c / a [s]; not for the vertical axis.
  double lagGain() const noexcept { return -lag_gain_ / lag_pole_; }
  double lagTime() const noexcept { return has_rate_ ? lag_damping_ / lag_pole_ : -1.0 / lag_pole_; }

  /// The lag where it is of second order.
  AngleLoop loop() const noexcept { return has_rate_ ? AngleLoop{-lag_pole_, -lag_damping_} : AngleLoop{}; }

  double drag() const noexcept { return -velocity_gain_; }  ///< the model's [1/s]
  /// Beyond the model's [1/s].
  double foundDrag() const noexcept { return disturbance_gain_ * dragCoefficient(); }
  double inputLower() const noexcept { return input_lower_; }
  double inputUpper() const noexcept { return input_upper_; }

 private:
  using Parameters = std::array<double, kMaxParameters>;

  // foundDrag() over disturbance_gain_.
  double dragCoefficient() const noexcept { return drag_ ? drag_->value() : 0.0; }
  AxisTarget goalOf(const AxisReference& reference) const noexcept;
  void bindSignals(const AxisNames& names);
  void prepareLookAhead(const AxisNames& names);
  void readModel(const MpcProblem& problem, const AxisNames& names);
  bool isLag(const MpcProblem& problem) const noexcept;
  Parameters parametersAt(const AxisValues& values) const noexcept;
  Parameters clipped(const Parameters& theta) const noexcept;
  int firstOutside(const Parameters& theta) const noexcept;
  ControlStatus answer(AxisReport& report, double& input) noexcept;
  double nextInput(const Prediction& at) const noexcept;
  Lookup answerShrunk(const AxisReport& report, double& input) noexcept;

  std::unique_ptr<AxisLaw> law_;
  std::array<AxisEntry, kMaxParameters> entries_{};
  Parameters lower_{};
  Parameters upper_{};
  int size_ = 0;
  double input_lower_ = 0.0;
  double input_upper_ = 0.0;

  bool has_lag_ = false;
  // Whether the lag is of second order.
  bool has_rate_ = false;
  bool has_input_reference_ = false;
  // Place of the disturbance ahead among the parameters; -1: none.
  int ahead_slot_ = -1;
  int position_state_ = 0;
  int velocity_state_ = 1;
  int angle_state_ = 2;
  int rate_state_ = 3;
  double velocity_gain_ = 0.0;                    // dv'/dv = -drag [1/s]
  double drive_gain_ = 0.0;                       // dv'/ds
  double disturbance_gain_ = 0.0;                 // dv'/dd
  double lag_pole_ = 0.0;                         // ds'/ds [1/s], or ds''/ds [1/s^2]
  double lag_damping_ = 0.0;                      // ds''/ds' [1/s]
  double lag_gain_ = 0.0;                         // ds'/du, or ds''/du
  double stage_period_ = 0.0;                     // Ts of the problem [s]
  std::array<std::array<double, 4>, 4> stage_{};  // A over Ts, for predictions
  std::array<double, 4> stage_input_{};           // B over Ts
  std::array<double, 4> stage_disturbance_{};     // B_d over Ts
  bool offset_free_ = true;
  DisturbanceObserver observer_;
  std::optional<CoefficientEstimate> drag_;
  AxisTarget goal_;
  // Of a minimum-peak robust MPC: share of the estimate that a control period adds to the constant part; 0: another law.
  double constant_share_ = 0.0;
  // The observer's estimate behind a lag, over disturbance_gain_.
  double constant_part_ = 0.0;
  // Whether the targets remove the constant part.
  bool removes_constant_ = false;
  // Where the law can look ahead and options.look_ahead is set.
  std::optional<StageReferences> stage_references_;
  bool looks_ahead_ = false;
  // Of a map that looks ahead: gives the disturbance ahead from the stages' references. Empty: none.
  Eigen::RowVectorXd ahead_row_;
  double disturbance_ahead_ = 0.0;
};

}  // namespace polyfly
