#pragma once

#include <Eigen/Core>
#include <vector>

#include "mpc_core/parametric_program.hpp"
#include "mpc_core/wide_matrix.hpp"

namespace polyfly {

/// What the program says at one parameter.
struct StrictAnswer {
  enum class Verdict { kOptimal, kInfeasible, kUndecided };
  Verdict verdict = Verdict::kUndecided;
  /// E z + C theta + c of the minimiser z.
  Eigen::VectorXd u;
  /// Rows with a multiplier that is not zero, or that regularisation alone makes tight.
  std::vector<int> pushing;
  /// Changes of the guessed set of tight rows.
  int changes = 0;
};

/// How a program is made strictly convex.
enum class Convexity {
  kAsGiven,      ///< it must be so where its equalities hold
  kShortest,     ///< by a tiny multiple of the identity: of several optima, the shortest z counts
  kFeasibility,  ///< the cost is |z|^2 instead: only whether there is a z matters
};

/// The optimum of a strictly convex program at single parameters, with 32 digits and on the program's own numbers: a dual
/// active-set method (Goldfarb and Idnani, 1983) that begins with a guess. From the right tight rows it takes no step, so it
/// then only checks the conditions of optimality. One object serves one thread.
class StrictQp {
 public:
  /// The program outlives the object, which may be used only if it is `definite`.
  StrictQp(const ParametricProgram& program, Convexity convexity);

  /// Where its equalities hold; false of H = 0.
  bool definite() const { return definite_; }

  /// `precision`: how far u may be from the optimum for each row that the answer violates, one for each input. Parameters
  /// outside of A_theta theta <= b_theta are infeasible.
  StrictAnswer solve(const Eigen::VectorXd& theta, const std::vector<int>& guess,
                     const Eigen::VectorXd& precision);

  /// Without a guess, with one precision for all inputs.
  StrictAnswer solve(const Eigen::VectorXd& theta, double precision) {
    return solve(theta, {}, Eigen::VectorXd::Constant(program_->inputCount(), precision));
  }

 private:
  using Vector = Eigen::Matrix<DoubleDouble, Eigen::Dynamic, 1>;

  WideMatrix hessian() const;
  void addEqualities(WideMatrix& H);
  void factorise(const WideMatrix& H);
  void setParameter(const Eigen::VectorXd& theta);
  void begin(const std::vector<int>& guess);
  bool append(int index);
  void remove(std::size_t place);
  WideMatrix tightRows() const;
  Vector solveTight(Vector right) const;
  void findMultipliers();
  void findMinimiser();
  int mostViolated(double reach) const;
  bool meet(int index);
  bool isEquality(int index) const { return equality_[static_cast<std::size_t>(index)] != 0; }
  Eigen::VectorXd output(const Eigen::VectorXd& theta) const;

  const ParametricProgram* program_;
  Convexity convexity_;
  bool definite_ = false;
  // Weight of the squares of the equalities in the cost.
  std::vector<double> equality_weights_;
  std::vector<char> equality_;
  // H = L L'.
  WideMatrix L_;
  // A column L^-1 a_i for each row, and its squared length.
  WideMatrix rows_;
  Vector squared_;
  // Lengths of L^-1 e_k of the outputs.
  Eigen::VectorXd output_length_;

  // At the current parameter: L^-1 g, bounds of the rows, minimiser.
  Vector gradient_, bounds_, z_;
  // Tight rows, their multipliers, and the Cholesky factor of their products, in its first rows and columns.
  std::vector<int> tight_;
  Vector multipliers_;
  WideMatrix factor_;
  int changes_ = 0;
};

}  // namespace polyfly
