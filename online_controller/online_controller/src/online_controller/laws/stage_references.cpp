#include "online_controller/laws/stage_references.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "mpc_core/decompositions.hpp"
#include "mpc_core/qp_kernels.hpp"

namespace polyfly {
namespace {

/// int_0^T e^{A (T - s)} B s / T ds: the end of a ramp's share of the input. With the input and its rate as further
/// states it is a block of the discretised model.
Eigen::VectorXd endOfRamp(const MpcProblem& problem) {
  const Eigen::Index nx = problem.stateCount();
  MpcProblem ramp = problem;
  ramp.A_c = Eigen::MatrixXd::Zero(nx + 1, nx + 1);
  ramp.A_c.topLeftCorner(nx, nx) = problem.A_c;
  ramp.A_c.topRightCorner(nx, 1) = problem.B_c;
  ramp.B_c = Eigen::MatrixXd::Zero(nx + 1, 1);
  ramp.B_c(nx, 0) = 1.0 / problem.sampling_time;
  ramp.Bd_c = Eigen::MatrixXd::Zero(nx + 1, 1);
  return discretise(ramp, problem.sampling_time).B.topRows(nx);
}

/// The problem's recursions, for references by columns.
struct Recursion {
  Eigen::MatrixXd A, P, Q;
  Eigen::VectorXd B, B_end;
  double R = 0.0;

  explicit Recursion(const MpcProblem& problem)
      : Q(problem.Q), B_end(endOfRamp(problem)), R(problem.R(0, 0)) {
    const DiscreteModel model = discretise(problem, problem.sampling_time);
    A = model.A;
    B = model.B;
    P = terminalWeight(problem, model);
  }

  /// r_0 .. r_N, from x_ss and u_ss of each stage.
  std::vector<Eigen::MatrixXd> shifts(const std::vector<Eigen::MatrixXd>& x,
                                      const std::vector<Eigen::RowVectorXd>& u) const {
    std::vector<Eigen::MatrixXd> r{Eigen::MatrixXd::Zero(A.rows(), u[0].cols())};
    for (std::size_t t = 0; t + 1 < x.size(); ++t) {
      const Eigen::MatrixXd w = A * x[t] + B * u[t] + B_end * (u[t + 1] - u[t]) - x[t + 1];
      r.push_back(A * r[t] + B * (u[t] - u[0]) - w);
    }
    return r;
  }

  /// The gradient of each stage.
  std::vector<Eigen::RowVectorXd> gradients(const std::vector<Eigen::MatrixXd>& r,
                                            const std::vector<Eigen::RowVectorXd>& u) const {
    const std::size_t N = r.size() - 1;
    std::vector<Eigen::RowVectorXd> gradients(N);
    Eigen::MatrixXd adjoint = P * r[N];
    for (std::size_t t = N; t-- > 0;) {
      gradients[t] = -2.0 * (B.transpose() * adjoint + R * (u[t] - u[0]));
      adjoint = (Q * r[t] + A.transpose() * adjoint).eval();
    }
    return gradients;
  }
};

}  // namespace

bool StageReferences::supports(const MpcProblem& problem) {
  if (problem.minimum_peak || problem.inputCount() != 1) return false;
  // What bounds errors would move with the references.
  if (problem.discrete || problem.terminal_equality || !problem.constraints.empty() || problem.T.rows() > 0)
    return false;
  return std::none_of(problem.states.begin(), problem.states.end(), [](const Signal& state) {
    return std::isfinite(state.lower) || std::isfinite(state.upper);
  });
}

StageReferences::StageReferences(const MpcProblem& problem, const Targets& targets)
    : horizon_(problem.horizon),
      states_(problem.stateCount()),
      blocks_(static_cast<int>(blockLengths(problem).size())),
      stride_(wholePacks(blocks_)) {
  const Eigen::Index count = kReferenceDerivatives * (horizon_ + 1);
  std::vector<Eigen::MatrixXd> x;
  std::vector<Eigen::RowVectorXd> u;
  for (int t = 0; t <= horizon_; ++t) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(states_ + 1, count);
    all.middleCols<kReferenceDerivatives>(kReferenceDerivatives * t) = targets;
    x.emplace_back(all.topRows(states_));
    u.emplace_back(all.bottomRows<1>());
  }
  const Recursion recursion(problem);
  const std::vector<Eigen::MatrixXd> r = recursion.shifts(x, u);
  shift_by_reference_.resize(states_ * (horizon_ + 1), count);
  for (int t = 0; t <= horizon_; ++t)
    shift_by_reference_.middleRows(states_ * t, states_) = r[static_cast<std::size_t>(t)];

  references_ = AlignedArray(static_cast<std::size_t>(count));
  gradient_ = AlignedArray(static_cast<std::size_t>(stride_));
  by_reference_ = AlignedArray(static_cast<std::size_t>(stride_ * count));
  const std::vector<Eigen::RowVectorXd> gradients = recursion.gradients(r, u);
  auto stage = gradients.begin();
  int block = 0;
  for (const int length : blockLengths(problem)) {
    for (const auto end = stage + length; stage != end; ++stage) {
      for (Eigen::Index i = 0; i < count; ++i) by_reference_[stride_ * i + block] += (*stage)(i);
    }
    ++block;
  }
}

const double* StageReferences::gradient() noexcept {
  std::fill_n(gradient_.data(), stride_, 0.0);
  qpKernels().addColumns(by_reference_.data(), stride_, stride_, nullptr,
                         kReferenceDerivatives * (horizon_ + 1), references_.data(), gradient_.data());
  return gradient_.data();
}

double StageReferences::greatest() const noexcept {
  return qpKernels().greatest(kReferenceDerivatives * (horizon_ + 1), references_.data());
}

Eigen::RowVectorXd StageReferences::gradientRow(const Eigen::RowVectorXd& weights) const {
  const Eigen::Map<const Eigen::MatrixXd, 0, Eigen::OuterStride<>> all(
      by_reference_.data(), blocks_, kReferenceDerivatives * (horizon_ + 1), Eigen::OuterStride<>(stride_));
  return weights * all;
}

double StageReferences::along(const Eigen::RowVectorXd& row) const noexcept {
  return qpKernels().dot(kReferenceDerivatives * (horizon_ + 1), row.data(), references_.data());
}

double StageReferences::shift(int stage, int state) const noexcept {
  const Eigen::Map<const Eigen::VectorXd> references(references_.data(), shift_by_reference_.cols());
  return shift_by_reference_.row(static_cast<Eigen::Index>(states_) * stage + state).dot(references);
}

}  // namespace polyfly
