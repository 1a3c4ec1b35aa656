#include <Eigen/LU>
#include <algorithm>

#include "condense_parts.hpp"

namespace polyfly {
namespace {

WideMatrix zero(Eigen::Index rows, Eigen::Index columns) { return WideMatrix::Zero(rows, columns); }

/// above, with `below` under it
WideMatrix stacked(const WideMatrix& above, const WideMatrix& below) {
  WideMatrix result(above.rows() + below.rows(), above.cols());
  result << above, below;
  return result;
}

/// left 0; 0 right
WideMatrix diagonal(const WideMatrix& left, const WideMatrix& right) {
  WideMatrix result = zero(left.rows() + right.rows(), left.cols() + right.cols());
  result.topLeftCorner(left.rows(), left.cols()) = left;
  result.bottomRightCorner(right.rows(), right.cols()) = right;
  return result;
}

}  // namespace

WideMatrix wideTerminalWeight(const MpcProblem& problem, const WideModel& model) {
  return problem.P.size() > 0 ? wide(problem.P)
                              : wideRiccati(model.A, model.B, wide(problem.Q), wide(problem.R));
}

// The state is s_k = (e_k, u~_{k-1}), and the cost from stage k on is s_k'P s_k + 2 s_k'r theta, but for terms in v and theta
// alone. The sum of squares for P loses nothing to cancellation.
Feedback feedbackOf(const MpcProblem& problem, const WideModel& model, const Selectors& selectors) {
  const Eigen::Index nx = problem.stateCount(), nu = problem.inputCount();
  const Eigen::Index n = problem.horizon * nu, p = selectors.drift.cols();
  const WideMatrix R = wide(problem.R), R_delta = wide(problem.R_delta);
  const WideMatrix A = diagonal(model.A, zero(nu, nu));
  const WideMatrix B = stacked(model.B, WideMatrix::Identity(nu, nu));
  const WideMatrix Q = diagonal(wide(problem.Q), zero(nu, nu));
  const WideMatrix drift = stacked(selectors.drift, zero(nu, p));
  WideMatrix before = zero(nu, nx + nu);
  before.rightCols(nu).setIdentity();
  WideMatrix P = diagonal(wideTerminalWeight(problem, model), zero(nu, nu));
  WideMatrix r = zero(nx + nu, p);
  Feedback feedback;
  feedback.H = zero(n, n);
  feedback.F = zero(n, p);
  const DoubleDouble two = 2.0;
  for (Eigen::Index at = n - nu; at >= 0; at -= nu) {
    const WideMatrix half = R + R_delta + B.transpose() * P * B;
    const WideMatrix K =
        Eigen::PartialPivLU<WideMatrix>(half).solve(B.transpose() * P * A - R_delta * before);
    const WideMatrix closed = A - B * K, change = K + before;
    const WideMatrix ahead = P * drift + r;
    feedback.K.push_back(K);
    feedback.H.block(at, at, nu, nu) = half + half.transpose();
    feedback.F.middleRows(at, nu) = B.transpose() * ahead * two;
    r = closed.transpose() * ahead;
    P = (closed.transpose() * P * closed + Q + K.transpose() * R * K + change.transpose() * R_delta * change)
            .eval();
    P = ((P + P.transpose()) * DoubleDouble(0.5)).eval();
  }
  std::reverse(feedback.K.begin(), feedback.K.end());
  return feedback;
}

Prediction predict(const MpcProblem& problem, const WideModel& model, const Selectors& selectors,
                   const Feedback* feedback) {
  const std::vector<int> blocks = blockLengths(problem);
  const Eigen::Index nx = problem.stateCount(), nu = problem.inputCount();
  const Eigen::Index n = static_cast<Eigen::Index>(blocks.size()) * nu;
  Prediction prediction;
  prediction.errors.push_back({zero(nx, n), selectors.error});
  Affine before{zero(nu, n), selectors.change};
  Eigen::Index at = 0;
  for (const int length : blocks) {
    for (int k = 0; k < length; ++k) {
      const Affine& error = prediction.errors.back();
      Affine move{zero(nu, n), zero(nu, selectors.error.cols())};
      move.on_z.middleCols(at, nu).setIdentity();
      if (feedback != nullptr) {
        const WideMatrix& K = feedback->K[prediction.moves.size()];
        move.on_z -= K * stacked(error.on_z, before.on_z);
        move.on_theta -= K * stacked(error.on_theta, before.on_theta);
      }
      Affine next{model.A * error.on_z + model.B * move.on_z,
                  model.A * error.on_theta + model.B * move.on_theta + selectors.drift};
      before = move;
      prediction.moves.push_back(std::move(move));
      prediction.errors.push_back(std::move(next));
    }
    at += nu;
  }
  return prediction;
}

}  // namespace polyfly
