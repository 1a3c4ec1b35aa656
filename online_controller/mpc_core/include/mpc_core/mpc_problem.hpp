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
};

/// The tracking problem of one axis, Eq. 3-4 and 38 in error coordinates (e = x - x_ref, u~ = u - u_ref).
struct MpcProblem {
  struct Parameter {
    /// Name, unit and range.
    Signal signal;
    ParameterRole role = ParameterRole::kError;
    /// Index of the state (kError) or of the input.
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
  std::vector<Signal> disturbances;  ///< nd
  Eigen::MatrixXd A_c;               ///< nx x nx, continuous time: x' = A_c x + B_c u + Bd_c d (Eq. 39)
  Eigen::MatrixXd B_c;               ///< nx x nu
  Eigen::MatrixXd Bd_c;              ///< nx x nd
  Eigen::MatrixXd C;                 ///< ny x nx, tracked output y = C x (ny = nu)

  double sampling_time = 0.0;  ///< Ts [s]
  int horizon = 0;             ///< N
  Eigen::MatrixXd Q;           ///< nx x nx
  Eigen::MatrixXd R;           ///< nu x nu
  Eigen::MatrixXd R_delta;     ///< nu x nu, Eq. 4
  std::vector<Parameter> parameters;

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

/// What a controller in flight needs of either type of problem: all of a tracking_mpc; of a robust_mpc
/// (region_maps/problems/robust) names, ranges of the inputs, matrices with G as Bd_c, sampling time and the
/// parameters with role error, whose map was solved offline. Throws Error; the model must be in continuous
/// time.
MpcProblem parseFlightModel(const std::string& text, const std::string& source);

/// Zero-order hold over `period` seconds by the matrix exponential (Eq. 42).
DiscreteModel discretise(const MpcProblem& problem, double period);

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

/// Eliminates the states (condensing): z = (u~_0 .. u~_{N-1}), theta in the order of problem.parameters,
/// terminal weight from the Riccati equation, output u_0 = u_ref + u~_0.
ParametricProgram condense(const MpcProblem& problem);

/// Reads either form by its ending (.yaml, .yml: tracking problem, condensed; .json: generic). Throws Error.
ParametricProgram loadProgram(const std::string& path);

/// The program that a map was made from, out of its own copy of the problem text.
/// `kind` is "yaml" or "json". Throws Error.
ParametricProgram parseProgram(const std::string& text, const std::string& kind, const std::string& source);

}  // namespace polyfly
