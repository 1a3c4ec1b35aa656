#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {

/// What an entry of the parameter vector of a tracking problem stands for.
enum class ParameterRole {
  kError,           ///< x - x_ref of one state
  kPreviousInput,   ///< input applied one period ago, u_{-1} of Eq. 4 (absolute)
  kInputReference,  ///< steady-state input u_ref of Eq. 6 (absolute)
  kStateReference,  ///< x_ref of one state (absolute), constant over the horizon
  kState,           ///< x of one state (absolute); x_ref and u_ref then follow from Eq. 6
  kReference,       ///< r of one output (Eq. 6), with kState
  kDisturbance,  ///< d, constant over the horizon: that of Eq. 6 with kState, else what x_ref and u_ref do not cover
};

/// A bound lower <= G_x x_k + G_u u_k <= upper along the horizon: for k = 1..N where it has no input, else for
/// k = 0..N-1.
struct StageConstraint {
  /// Which stages share a slack.
  enum class Slack {
    kPerStage,    ///< each stage has its own: the weights add up over the stages
    kPerHorizon,  ///< one for all: the weights count for the greatest excess
  };

  /// Name, unit and bounds; one bound may be infinite.
  Signal signal;
  Eigen::RowVectorXd G_x;  ///< nx
  Eigen::RowVectorXd G_u;  ///< nu
  /// True: x and u themselves are bounded. False: x - x_ref and u - u_ref are.
  bool absolute = true;

  /// True: the bound may be exceeded by v >= 0 at the cost linear_weight v + quadratic_weight v^2, besides Eq. 4.
  bool soft = false;
  double linear_weight = 0.0;     ///< 0 or more [1 / unit]
  double quadratic_weight = 0.0;  ///< above 0 [1 / unit^2]
  Slack slack = Slack::kPerStage;
};

/// The tracking problem of one axis, Eq. 3-4 and 38 in error coordinates (e = x - x_ref, u~ = u - u_ref).
struct MpcProblem {
  struct Parameter {
    /// Name, unit and range.
    Signal signal;
    ParameterRole role = ParameterRole::kError;
    /// Index of the state, input, output or disturbance that the role belongs to.
    int index = 0;
  };

  std::string name;
  std::string description;
  /// Path of the file, for messages.
  std::string source;
  /// Text of the file, verbatim.
  std::string text;

  /// The nx states; lower and upper are the bounds on x - x_ref, infinite if none.
  std::vector<Signal> states;
  /// The nu inputs, with the bounds of u (absolute).
  std::vector<Signal> inputs;
  /// The nd disturbances, with the range that each stays in, infinite where none is given. The program does not depend on
  /// the ranges.
  std::vector<Signal> disturbances;
  /// The ny outputs; the name is empty where the file gives none and the row of C is not that of one state.
  std::vector<Signal> outputs;
  /// False: the model is x' = A_c x + B_c u + Bd_c d (Eq. 39). True: x_{k+1} = A_c x_k + B_c u_k + Bd_c d_k over one
  /// sampling time.
  bool discrete = false;
  Eigen::MatrixXd A_c;   ///< nx x nx
  Eigen::MatrixXd B_c;   ///< nx x nu
  Eigen::MatrixXd Bd_c;  ///< nx x nd
  Eigen::MatrixXd C;     ///< ny x nx, tracked output y = C x (ny = nu)

  /// Dead time before an input acts, over which the controller predicts; the problem itself has none [s].
  double delay = 0.0;

  double sampling_time = 0.0;  ///< Ts [s]
  int horizon = 0;             ///< N
  /// Lengths of the blocks over which u is held, with sum N; empty: every stage has its own u.
  std::vector<int> moves;
  /// Bounds on u_k - u_{k-1}, infinite where there are none; empty: none at all.
  std::vector<Signal> changes;
  Eigen::MatrixXd Q;               ///< nx x nx
  Eigen::MatrixXd R;               ///< nu x nu
  Eigen::MatrixXd R_delta;         ///< nu x nu, Eq. 4
  Eigen::MatrixXd P;               ///< nx x nx, given terminal weight; empty: that of the Riccati equation
  bool terminal_equality = false;  ///< x_N = x_ref; P is then empty
  Eigen::MatrixXd T;               ///< rows x nx, terminal set T e_N <= t; may have no rows
  Eigen::VectorXd t;               ///< rows
  std::vector<StageConstraint> constraints;
  /// theta.
  std::vector<Parameter> parameters;
  /// Like parameters, with a value (lower = upper) instead of a range. They are no entries of theta.
  std::vector<Parameter> fixed_parameters;

  /// True: only the model and the errors of a robust_mpc problem, see parseFlightModel.
  bool minimum_peak = false;

  int stateCount() const { return static_cast<int>(A_c.rows()); }
  int inputCount() const { return static_cast<int>(B_c.cols()); }
};

/// x_{k+1} = A x_k + B u_k + Bd d_k
struct DiscreteModel {
  Eigen::MatrixXd A;
  Eigen::MatrixXd B;
  Eigen::MatrixXd Bd;
  double period = 0.0;  ///< [s]
};

/// Reads a problem file (region_maps/problems/*.yaml). Throws Error `file:line: field: rule`.
MpcProblem loadProblem(const std::string& path);

/// As loadProblem, from text; `source` is used in errors.
MpcProblem parseProblem(const std::string& text, const std::string& source);

/// What a controller in flight needs of either type of problem. Of a tracking_mpc that is all. The map of a
/// robust_mpc (region_maps/problems/robust) was solved offline. Of it, the controller needs names, ranges of the
/// inputs, matrices with G as Bd_c, sampling time, and the parameters with role error. Throws Error; the model must
/// be in continuous time.
MpcProblem parseFlightModel(const std::string& text, const std::string& source);

/// Zero-order hold over `period` seconds by the matrix exponential (Eq. 42). A discrete model is taken as it is where
/// `period` is its sampling time; for another period it goes through continuousModel. Throws Error.
DiscreteModel discretise(const MpcProblem& problem, double period);

/// The problem with the model in continuous time: a discrete one by the matrix logarithm, whose entries below 1e-12 of the
/// greatest one become 0. Throws Error when there is none, because A has an eigenvalue that is 0 or negative.
MpcProblem continuousModel(const MpcProblem& problem);

/// Stabilising solution P of the discrete algebraic Riccati equation,
/// P = A'PA - A'PB (R + B'PB)^-1 B'PA + Q. Throws Error when the iteration does not converge.
Eigen::MatrixXd solveRiccati(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B, const Eigen::MatrixXd& Q,
                             const Eigen::MatrixXd& R);

/// State and input that hold the output at r under the disturbance d (Eq. 6).
struct SteadyState {
  Eigen::VectorXd x;
  Eigen::VectorXd u;
};
SteadyState steadyState(const DiscreteModel& model, const Eigen::MatrixXd& C, const Eigen::VectorXd& d,
                        const Eigen::VectorXd& r);

/// P of Eq. 4: the given one, or the solution of the Riccati equation. Throws Error.
Eigen::MatrixXd terminalWeight(const MpcProblem& problem, const DiscreteModel& model);

/// Lengths of the blocks over which u is held: problem.moves, or N times 1.
std::vector<int> blockLengths(const MpcProblem& problem);

/// u~ of the blocks: on_z z + on_theta theta + constant, where z has no slacks.
struct InputPlan {
  Eigen::MatrixXd on_z, on_theta;
  Eigen::VectorXd constant;

  /// Whether z are the inputs themselves.
  bool isOfInputs() const noexcept { return on_z.isIdentity(0.0); }
};

/// Eliminates the states (condensing), in about 32 digits, and rounds once: z = (u~ of each block, slacks of the soft bounds),
/// theta in the order of problem.parameters, output u_0 = u_ref + u~_0. Where H of the free inputs, with a diagonal of ones,
/// has a condition above 1e8, v_k takes the place of u~_k = -K_k (e_k, u~_{k-1}) + v_k. K_k are the gains of the problem's
/// own Riccati recursion, so that H is block diagonal, and bounds of inputs become rows. `plan` tells u~ from z. Throws Error
/// where rounding may change an input by more than a millionth of its range.
ParametricProgram condense(const MpcProblem& problem, InputPlan* plan = nullptr);

/// What Eq. 4 costs at z = 0: (theta, 1)' M (theta, 1), which the cost of the program leaves out. p + 1 rows.
Eigen::MatrixXd costAtZero(const MpcProblem& problem);

/// Reads either form by its ending (.yaml, .yml: tracking problem, condensed; .json: generic). Throws Error.
ParametricProgram loadProgram(const std::string& path);

/// The program that a map was made from, out of its own copy of the problem text.
/// `kind` is "yaml" or "json". Throws Error.
ParametricProgram parseProgram(const std::string& text, const std::string& kind, const std::string& source);

}  // namespace polyfly
