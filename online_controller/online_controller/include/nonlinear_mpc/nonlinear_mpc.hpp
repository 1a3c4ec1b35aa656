#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/aligned_array.hpp"
#include "mpc_core/bounded_qp.hpp"
#include "mpc_core/stage_condensing.hpp"
#include "nonlinear_mpc/multirotor_model.hpp"
#include "polyfly_base/range.hpp"

namespace polyfly {

/// The optimal control problem of Eq. 43 in discrete time. The defaults are those of a Firefly.
struct NonlinearMpcOptions {
  MultirotorModel model;
  int horizon = 20;     ///< N, stages, 1 .. 100
  double period = 0.1;  ///< Ts [s]

  Eigen::Vector3d position_weight{80.0, 80.0, 120.0};  ///< [1/m^2]
  Eigen::Vector3d velocity_weight{80.0, 80.0, 100.0};  ///< [s^2/m^2]
  double roll_weight = 10.0;                           ///< [1/rad^2]
  double pitch_weight = 10.0;                          ///< [1/rad^2]
  double roll_command_weight = 50.0;                   ///< [1/rad^2]
  double pitch_command_weight = 50.0;                  ///< [1/rad^2]
  /// Weight of z_B T - g [s^4/m^2].
  double thrust_weight = 1.0;

  /// Bound of the roll and pitch commands [rad].
  double angle_max = 0.4363323;
  /// Least thrust over mass [m/s^2].
  double thrust_min = 5.0;
  /// Greatest thrust over mass [m/s^2].
  double thrust_max = 20.0;

  /// Whether NonlinearController takes the limits of the chapter's listing (below Eq. 43) instead of the vehicle's: commands
  /// of roll and pitch within 45 degrees, thrust over mass within g / 2 and 3 g / 2.
  bool chapter_limits = false;

  /// Limit of each component of the velocity [m/s]; 0: not limited.
  double speed_max = 0.0;
  /// Working sets that the feedback may try, the bound of its time: then it answers with what it has. 0: the
  /// solver's own bound, 10 (inputs + rows) + 30.
  int working_sets_max = 0;
};

/// The one list of the options but those that come from the vehicle's (gravity, limits): calls
/// visit(key, field, unit, range). Keys are parameter names relative to a node's private namespace.
template <class Options, class Visit>
void visitNonlinearOptions(Options& options, Visit&& visit) {
  auto& model = options.model;
  visit("nonlinear/roll_gain", model.roll_gain, "1", Range{0.01, 10.0, 1.5});
  visit("nonlinear/roll_time", model.roll_time, "s", Range{0.002, 10.0, 1.5});
  visit("nonlinear/pitch_gain", model.pitch_gain, "1", Range{0.01, 10.0, 1.5});
  visit("nonlinear/pitch_time", model.pitch_time, "s", Range{0.002, 10.0, 1.5});
  visit("nonlinear/drag_x", model.drag.x(), "1/s", Range{0.0, 10.0, 2.0, 0.1});
  visit("nonlinear/drag_y", model.drag.y(), "1/s", Range{0.0, 10.0, 2.0, 0.1});
  visit("nonlinear/drag_z", model.drag.z(), "1/s", Range{0.0, 10.0, 2.0, 0.1});
  visit("nonlinear/horizon", options.horizon, "stages", Range{1.0, 100.0});
  visit("nonlinear/period", options.period, "s", Range{0.001, 1.0});
  visit("nonlinear/position_weight_x", options.position_weight.x(), "1/m^2", Range{0.0, 1e6, 10.0, 1.0});
  visit("nonlinear/position_weight_y", options.position_weight.y(), "1/m^2", Range{0.0, 1e6, 10.0, 1.0});
  visit("nonlinear/position_weight_z", options.position_weight.z(), "1/m^2", Range{0.0, 1e6, 10.0, 1.0});
  visit("nonlinear/velocity_weight_x", options.velocity_weight.x(), "s^2/m^2", Range{0.0, 1e6, 10.0, 1.0});
  visit("nonlinear/velocity_weight_y", options.velocity_weight.y(), "s^2/m^2", Range{0.0, 1e6, 10.0, 1.0});
  visit("nonlinear/velocity_weight_z", options.velocity_weight.z(), "s^2/m^2", Range{0.0, 1e6, 10.0, 1.0});
  visit("nonlinear/roll_weight", options.roll_weight, "1/rad^2", Range{0.0, 1e6, 10.0, 1.0});
  visit("nonlinear/pitch_weight", options.pitch_weight, "1/rad^2", Range{0.0, 1e6, 10.0, 1.0});
  visit("nonlinear/roll_command_weight", options.roll_command_weight, "1/rad^2", Range{1e-3, 1e6});
  visit("nonlinear/pitch_command_weight", options.pitch_command_weight, "1/rad^2", Range{1e-3, 1e6});
  visit("nonlinear/thrust_weight", options.thrust_weight, "s^4/m^2", Range{1e-3, 1e6});
  visit("nonlinear/chapter_limits", options.chapter_limits);
  visit("nonlinear/speed_max", options.speed_max, "m/s", anyChange(0.0, 1000.0));
  visit("nonlinear/working_sets_max", options.working_sets_max, "working sets", anyChange(0.0, 100000.0));
}

/// What one stage shall follow: entries of h in the chapter's order.
struct StageReference {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< [m]
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< [m/s]
  double roll = 0.0;                                   ///< [rad]
  double pitch = 0.0;                                  ///< [rad]
  double roll_command = 0.0;                           ///< [rad]
  double pitch_command = 0.0;                          ///< [rad]
  double lift = 9.8066;                                ///< z component of z_B T [m/s^2]
};

/// Nonlinear model predictive control by the real-time iteration (Diehl, Bock and Schloeder, 2005). Each sample takes
/// one Gauss-Newton step from the last solution, moved on in time.
///
/// Multiple shooting with the analytic derivatives of integrateStage, condensing to the N x 3 inputs
/// (Andersson, 2013), BoundedQp with the last active set. A step has two parts: prepare() linearises,
/// condenses and factorises before the state is known; feedback() takes the state and solves. The terminal
/// weight is the solution of the discrete Riccati equation of the model at hover, turned by the yaw at the
/// end. The limit of the velocity is relaxed in the l1 norm, so that the problem always has a solution. The relaxation is
/// exact: the limit holds wherever it can, as long as the penalty exceeds its multipliers.
///
/// After construction nothing allocates, throws or reads a clock. One object serves one thread.
class NonlinearMpc {
 public:
  /// Throws Error naming the option and its range.
  explicit NonlinearMpc(const NonlinearMpcOptions& options);

  /// Begins anew: the input `u` held over the horizon, states integrated from x.
  void start(const MultirotorState& x, const MultirotorInput& u, const StageConditions* stages) noexcept;

  /// Moves the solution on by `share` of a stage, 0 .. 1, between neighbouring stages linearly.
  void shift(double share) noexcept;

  /// Linearises about the solution. `stages` has N entries. False when the QP cannot be built.
  bool prepare(const StageConditions* stages) noexcept;

  /// Solves the QP for the state x and N + 1 references; the last one's commands do not count. Call prepare() before
  /// each call. Returns kOptimal, or kIterationLimit where the search ended early. Then a line search on the cost has
  /// moved the solution towards the last iterate, within all limits. stepLength() is 0 where the cost does not fall.
  /// Any other status leaves the solution unchanged.
  QpStatus feedback(const MultirotorState& x, const StageReference* references) noexcept;

  /// Goes on with the solution of another one. False, and nothing is done, when its stages are others.
  bool transferState(const NonlinearMpc& other) noexcept;

  int horizon() const noexcept { return options_.horizon; }
  const NonlinearMpcOptions& options() const noexcept { return options_; }
  const MultirotorInput& input(int k) const noexcept { return inputs_[static_cast<std::size_t>(k)]; }
  const MultirotorState& state(int k) const noexcept { return states_[static_cast<std::size_t>(k)]; }

  /// Length of the last step: greatest change of an input [rad, m/s^2].
  double stepLength() const noexcept { return step_length_; }
  /// Number of working sets of the last QP.
  int iterations() const noexcept { return qp_.iterations(); }
  /// KKT residual of the last QP.
  double kktResidual() const noexcept { return qp_.kktResidual(); }
  /// Greatest violation of the linearised limit of the velocity [m/s].
  double stateViolation() const noexcept { return qp_.violation(); }

 private:
  using Condensing = StageCondensing<kMultirotorStates, kMultirotorInputs>;
  /// What feedback() reads of a stage beside A and B.
  struct Transition {
    MultirotorState defect;  // f(x_k, u_k) - x_{k+1}
    // Derivative of z_B T by roll, pitch, T.
    Eigen::Vector3d lift_slope;
    double lift = 0.0;  // z_B T
  };

  // Rows of the QP: the components of the velocity at each stage but the first, where they are limited.
  int rowCount() const noexcept { return options_.speed_max > 0.0 ? 3 * options_.horizon : 0; }
  void computeTerminalWeight();
  void linearise(const StageConditions* stages) noexcept;
  void weigh(int k) noexcept;
  void weighEnd(double yaw) noexcept;
  void setSoftRows() noexcept;
  void propagate(const MultirotorState& deviation) noexcept;
  void computeGradient(const StageReference* references) noexcept;
  double shareOfStep() const noexcept;
  double costOfRows(double share) const noexcept;
  void expand(double share) noexcept;

  NonlinearMpcOptions options_;
  Condensing condensing_;
  BoundedQp qp_;
  // Terminal weight at yaw 0.
  Condensing::StateMatrix hover_weight_;
  MultirotorState state_weight_;

  std::vector<Transition> transitions_;  // N
  std::vector<MultirotorState> states_;  // N + 1
  std::vector<MultirotorState> deviations_;
  std::vector<MultirotorInput> inputs_;  // N
  AlignedArray g_, lower_, upper_, rows_, row_lower_, row_upper_;
  double step_length_ = 0.0;
};

}  // namespace polyfly
