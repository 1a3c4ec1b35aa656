#include "full_space.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "mpc_core/dense_qp.hpp"

namespace polyfly_test {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::RowVectorXd;
using Eigen::VectorXd;
using polyfly::MpcProblem;
using polyfly::StageConstraint;

/// Rows over the variables (x_1 .. x_N, u_0 .. u_{N-1}, slacks).
class FullSpace {
 public:
  FullSpace(const MpcProblem& problem, const polyfly::DiscreteModel& model, MatrixXd P, const Situation& at)
      : problem_(problem), model_(model), P_(std::move(P)), at_(at), N_(problem.horizon) {
    nx_ = at.x.size();
    nu_ = at.u_ref.size();
    for (const StageConstraint& constraint : problem.constraints) {
      if (!constraint.soft) continue;
      slacks_ += constraint.slack == StageConstraint::Slack::kPerHorizon ? 1 : N_;
    }
    size_ = N_ * (nx_ + nu_) + slacks_;
    H_ = MatrixXd::Zero(size_, size_);
    g_ = VectorXd::Zero(size_);
  }

  FullSpaceAnswer solve() {
    addCost();
    addModel();
    addInputs();
    addStates();
    Index next = N_ * (nx_ + nu_);
    for (const StageConstraint& constraint : problem_.constraints) addConstraint(constraint, &next);
    MatrixXd rows(static_cast<Index>(rows_.size()), size_);
    for (Index i = 0; i < rows.rows(); ++i) rows.row(i) = rows_[static_cast<std::size_t>(i)];
    polyfly::DenseQp qp(H_, rows, equalities_);
    FullSpaceAnswer answer;
    answer.status = qp.solve(g_.data(), bounds_.data());
    answer.u = Eigen::Map<const MatrixXd>(qp.z().data() + N_ * nx_, nu_, N_);
    answer.excess = VectorXd::Zero(static_cast<Index>(problem_.constraints.size()));
    for (const auto& [constraint, variable] : owners_)
      answer.excess(constraint) = std::max(answer.excess(constraint), qp.z()(variable));
    return answer;
  }

 private:
  Index x(int stage) const { return (stage - 1) * nx_; }
  Index u(int stage) const { return N_ * nx_ + stage * nu_; }

  void add(const RowVectorXd& row, double bound) {
    if (!std::isfinite(bound)) return;
    rows_.push_back(row);
    bounds_.push_back(bound);
  }
  void addEquality(const RowVectorXd& row, double value) {
    equalities_.push_back(static_cast<int>(rows_.size()));
    add(row, value);
  }
  void addRange(const RowVectorXd& row, double lower, double upper, double offset) {
    add(row, upper - offset);
    add(-row, offset - lower);
  }

  void addSquare(const MatrixXd& weight, Index first, const VectorXd& centre) {
    H_.block(first, first, weight.rows(), weight.rows()) += 2.0 * weight;
    g_.segment(first, weight.rows()) -= 2.0 * weight * centre;
  }

  void addCost() {
    for (int k = 1; k <= N_; ++k) addSquare(k < N_ ? problem_.Q : P_, x(k), at_.x_ref);
    for (int k = 0; k < N_; ++k) {
      addSquare(problem_.R, u(k), at_.u_ref);
      if (k == 0) {
        addSquare(problem_.R_delta, u(0), at_.u_previous);
        continue;
      }
      MatrixXd difference = MatrixXd::Zero(nu_, size_);
      difference.middleCols(u(k), nu_).setIdentity();
      difference.middleCols(u(k - 1), nu_) -= MatrixXd::Identity(nu_, nu_);
      H_ += 2.0 * difference.transpose() * problem_.R_delta * difference;
    }
  }

  void addModel() {
    for (int k = 0; k < N_; ++k) {
      for (Index i = 0; i < nx_; ++i) {
        RowVectorXd row = RowVectorXd::Zero(size_);
        row(x(k + 1) + i) = 1.0;
        row.segment(u(k), nu_) = -model_.B.row(i);
        double value = at_.w(i);
        if (k == 0) value += model_.A.row(i).dot(at_.x);
        if (k > 0) row.segment(x(k), nx_) = -model_.A.row(i);
        addEquality(row, value);
      }
    }
  }

  void addInputs() {
    std::vector<bool> begins(static_cast<std::size_t>(N_), problem_.moves.empty());
    int stage = 0;
    for (const int length : problem_.moves) {
      begins[static_cast<std::size_t>(stage)] = true;
      stage += length;
    }
    for (int k = 0; k < N_; ++k) {
      for (Index i = 0; i < nu_; ++i) {
        const polyfly::Signal& input = problem_.inputs[static_cast<std::size_t>(i)];
        const RowVectorXd here = RowVectorXd::Unit(size_, u(k) + i);
        addRange(here, input.lower, input.upper, 0.0);
        const RowVectorXd change = k == 0 ? here : here - RowVectorXd::Unit(size_, u(k - 1) + i);
        if (!begins[static_cast<std::size_t>(k)]) addEquality(change, 0.0);
        if (problem_.changes.empty() || !begins[static_cast<std::size_t>(k)]) continue;
        const polyfly::Signal& range = problem_.changes[static_cast<std::size_t>(i)];
        addRange(change, range.lower, range.upper, k == 0 ? -at_.u_previous(i) : 0.0);
      }
    }
  }

  void addStates() {
    for (int k = 1; k <= N_; ++k) {
      for (Index i = 0; i < nx_; ++i) {
        const polyfly::Signal& state = problem_.states[static_cast<std::size_t>(i)];
        addRange(RowVectorXd::Unit(size_, x(k) + i), state.lower, state.upper, -at_.x_ref(i));
      }
    }
    for (Index i = 0; problem_.terminal_equality && i < nx_; ++i)
      addEquality(RowVectorXd::Unit(size_, x(N_) + i), at_.x_ref(i));
    for (Index i = 0; i < problem_.T.rows(); ++i) {
      RowVectorXd row = RowVectorXd::Zero(size_);
      row.segment(x(N_), nx_) = problem_.T.row(i);
      add(row, problem_.t(i) + problem_.T.row(i).dot(at_.x_ref));
    }
  }

  void addConstraint(const StageConstraint& constraint, Index* next) {
    const bool has_input = constraint.G_u.cwiseAbs().maxCoeff() > 0.0;
    const bool shared = constraint.slack == StageConstraint::Slack::kPerHorizon;
    const Index which = &constraint - problem_.constraints.data();
    for (int i = 0; i < N_; ++i) {
      const int k = has_input ? i : i + 1;
      RowVectorXd row = RowVectorXd::Zero(size_);
      double offset = 0.0;
      if (k == 0) offset += constraint.G_x.dot(at_.x);
      if (k > 0) row.segment(x(k), nx_) = constraint.G_x;
      if (has_input) row.segment(u(k), nu_) = constraint.G_u;
      if (!constraint.absolute) offset -= constraint.G_x.dot(at_.x_ref) + constraint.G_u.dot(at_.u_ref);
      RowVectorXd relief = RowVectorXd::Zero(size_);
      if (constraint.soft) {
        relief(*next) = -1.0;
        if (!shared || i == 0) {
          H_(*next, *next) = 2.0 * constraint.quadratic_weight;
          g_(*next) = constraint.linear_weight;
          add(relief, 0.0);
          owners_.push_back({which, *next});
        }
        if (!shared || i + 1 == N_) ++*next;
      }
      add(row + relief, constraint.signal.upper - offset);
      add(-row + relief, offset - constraint.signal.lower);
    }
  }

  const MpcProblem& problem_;
  const polyfly::DiscreteModel& model_;
  MatrixXd P_;
  const Situation& at_;
  int N_;
  Index nx_ = 0, nu_ = 0, slacks_ = 0, size_ = 0;
  MatrixXd H_;
  VectorXd g_;
  std::vector<RowVectorXd> rows_;
  std::vector<double> bounds_;
  std::vector<int> equalities_;
  std::vector<std::pair<Index, Index>> owners_;
};

}  // namespace

FullSpaceAnswer solveFullSpace(const MpcProblem& problem, const polyfly::DiscreteModel& model,
                               const MatrixXd& P, const Situation& at) {
  return FullSpace(problem, model, P, at).solve();
}

}  // namespace polyfly_test
