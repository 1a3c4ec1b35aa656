#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/LU>
#include <vector>

#include "mpc_core/decompositions.hpp"

namespace polyfly {

enum class InteriorPointStatus {
  kOptimal,     ///< KKT residual within kInteriorPointAccuracy
  kInfeasible,  ///< `lambda` is a Farkas certificate: >= 0 on inequalities, A'lambda = 0, b'lambda < 0
  kUnbounded,   ///< a direction of unlimited descent was found
  kInaccurate,  ///< no certificate of any kind; `residual` says how far off
};

const char* toString(InteriorPointStatus status);

struct InteriorPointSolution {
  InteriorPointStatus status = InteriorPointStatus::kInaccurate;
  Eigen::VectorXd z;       ///< n
  Eigen::VectorXd lambda;  ///< m, >= 0 on inequalities, free on equalities
  double objective = 0.0;
  double residual = 0.0;  ///< greatest of the scaled KKT residuals, see InteriorPointQp
  int iterations = 0;
};

/// Convex QP (H = 0: LP)  min 1/2 z'Hz + g'z  s.t.  A z <= b (rows in `equalities` with "=")
/// by Mehrotra's predictor-corrector method and a final active-set correction. It exists to check the
/// parametric solver and shares no code with it.
///
/// Equalities are eliminated through an orthonormal basis of their null space, so they may be
/// dependent. `residual` is the greatest of: stationarity and negative multipliers, divided by max(1, |g|,
/// |H|); violated rows, scaled to unit normals and divided by max(1, |b_i|); and, per row, the smaller of
/// multiplier and slack so scaled. (Their product would call a multiplier and a slack of 1e-6 each accurate
/// to 1e-12.)
class InteriorPointQp {
 public:
  /// H n x n symmetric positive semidefinite, A m x n.
  InteriorPointQp(const Eigen::MatrixXd& H, const Eigen::MatrixXd& A, std::vector<int> equalities = {});

  /// `g` n, `b` m. The reference is valid until the next call.
  const InteriorPointSolution& solve(const Eigen::VectorXd& g, const Eigen::VectorXd& b);

 private:
  enum class End { kConverged, kStalled, kInfeasible, kUnbounded };

  bool reduce(const Eigen::VectorXd& g, const Eigen::VectorXd& b);
  void start();
  End iterate();
  void factorise();
  void direction(const Eigen::VectorXd& complementarity);
  double stepLength() const;
  bool provesInfeasible();
  bool provesUnbounded();
  void setCertificate();
  void polish();
  void follow(std::vector<int> active, double& best);
  bool correct(const std::vector<int>& active);
  double reducedResidual() const;
  void addEqualityMultipliers(const Eigen::VectorXd& gradient);
  void expand(const Eigen::VectorXd& g, const Eigen::VectorXd& b);

  // The problem as given.
  Eigen::MatrixXd H_, A_;
  std::vector<int> equalities_;
  Eigen::VectorXd row_norm_;
  double H_scale_ = 0.0;

  // z = z0 + N y; inequality rows in y with unit normals. Rows without a normal left in y are in `fixed_`.
  Eigen::MatrixXd A_eq_, N_;
  ShortestLeastSquares eq_factor_, eq_transposed_factor_;
  Eigen::MatrixXd H_y_, A_y_;
  std::vector<int> rows_, fixed_;
  Eigen::VectorXd norm_y_;

  // The current right-hand sides and iterate: min 1/2 y'Hy + g'y, A y + s = b, s >= 0; cost times kappa_.
  Eigen::VectorXd z0_, g_y_, b_y_;
  double kappa_ = 1.0;
  Eigen::VectorXd y_, s_, l_;
  Eigen::VectorXd r_dual_, r_primal_, dy_, ds_, dl_;
  double mu_ = 0.0;
  bool careful_ = false;  // second attempt: slower and more accurate linear algebra

  // Work space.
  Eigen::MatrixXd normal_, scaled_rows_;
  Eigen::VectorXd weight_, rhs_, target_, row_work_, y_work_, best_y_, best_l_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd newton_;
  Eigen::VectorXd row_scale_, newton_step_;
  Eigen::PartialPivLU<Eigen::MatrixXd> newton_factor_;
  InteriorPointSolution solution_;
};

}  // namespace polyfly
