// Written from the stacked matrices of Eq. 13 to 34, apart from robust_program.cpp, so that each can check
// the other.
#include "full_program.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "../src/rational_parts.hpp"
#include "robust_mpc/robust_program.hpp"

namespace polyfly {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// X = A_s e + B_s U + G_s W + drift_s (Eq. 13).
struct StackedModel {
  MatrixXd A, B, G;
  VectorXd drift;
};

StackedModel stackModel(const RobustProblem& problem) {
  const MatrixXd A = toDoubles(problem.A), B = toDoubles(problem.B), G = toDoubles(problem.G);
  const int nx = problem.stateCount(), N = problem.horizon;
  const int nu = problem.inputCount(), nw = problem.channelCount();
  VectorXd drift(nx);
  for (int i = 0; i < nx; ++i) drift[i] = nearestDouble(problem.drift[at(i)]);
  const int first = problem.stack == Stack::kPaper ? 0 : 1;
  StackedModel model{MatrixXd::Zero(N * nx, nx), MatrixXd::Zero(N * nx, N * nu),
                     MatrixXd::Zero(N * nx, N * nw), VectorXd::Zero(N * nx)};
  std::vector<MatrixXd> power{MatrixXd::Identity(nx, nx)};
  while (static_cast<int>(power.size()) <= N) power.push_back(A * power.back());
  for (int block = 0; block < N; ++block) {
    const int k = first + block;
    model.A.middleRows(block * nx, nx) = power[at(k)];
    for (int j = 0; j < k; ++j) {
      model.B.block(block * nx, j * nu, nx, nu) = power[at(k - 1 - j)] * B;
      model.G.block(block * nx, j * nw, nx, nw) = power[at(k - 1 - j)] * G;
      model.drift.segment(block * nx, nx) += power[at(k - 1 - j)] * drift;
    }
  }
  return model;
}

/// direction . (X, U) <= limit + shift . theta for all disturbances: a row of E_x or E_u with its bound.
struct Limit {
  VectorXd x;
  VectorXd u;
  double bound = 0.0;
  VectorXd shift;
};

class FullBuilder {
 public:
  explicit FullBuilder(const RobustProblem& problem)
      : problem_(problem),
        model_(stackModel(problem)),
        nx_(problem.stateCount()),
        nu_(problem.inputCount()),
        nw_(problem.channelCount()),
        ny_(problem.outputCount()),
        N_(problem.horizon),
        np_(problem.parameterCount()) {
    listLimits();
    number();
  }

  FullProgram build() {
    addPeaks();
    addLimits();
    addFeedback();
    addSigns();
    FullProgram program;
    program.A.resize(static_cast<Eigen::Index>(bounds_.size()), count_);
    program.S.resize(static_cast<Eigen::Index>(bounds_.size()), np_);
    program.b.resize(static_cast<Eigen::Index>(bounds_.size()));
    for (std::size_t i = 0; i < bounds_.size(); ++i) {
      program.A.row(static_cast<Eigen::Index>(i)) = rows_[i];
      program.S.row(static_cast<Eigen::Index>(i)) = shifts_[i];
      program.b[static_cast<Eigen::Index>(i)] = bounds_[i];
    }
    program.c = VectorXd::Zero(count_);
    program.c[tau_] = 1.0;
    program.peak = tau_;
    return program;
  }

 private:
  Limit noLimit() const {
    return {VectorXd::Zero(N_ * nx_), VectorXd::Zero(N_ * nu_), 0.0, VectorXd::Zero(np_)};
  }

  VectorXd referencePart(RationalVector RobustProblem::Parameter::*shifts, int i) const {
    VectorXd part = VectorXd::Zero(np_);
    for (int j = 0; j < np_; ++j) {
      const RobustProblem::Parameter& parameter = problem_.parameters[at(j)];
      if (parameter.state < 0) part[j] = nearestDouble((parameter.*shifts)[at(i)]);
    }
    return part;
  }

  void listLimits() {
    for (int block = 0; block < N_; ++block) {
      for (int i = 0; i < nx_; ++i) {
        const auto& range = problem_.state_ranges[at(i)];
        if (!range) continue;
        for (const int sign : {1, -1}) {
          Limit limit = noLimit();
          limit.x[block * nx_ + i] = sign;
          limit.bound = sign > 0 ? nearestDouble(range->upper) : -nearestDouble(range->lower);
          limit.shift = -sign * referencePart(&RobustProblem::Parameter::state_shift, i);
          limits_.push_back(std::move(limit));
        }
      }
      for (int i = 0; i < nu_; ++i) {
        const RobustProblem::Range& range = problem_.input_ranges[at(i)];
        for (const int sign : {1, -1}) {
          Limit limit = noLimit();
          limit.u[block * nu_ + i] = sign;
          limit.bound = sign > 0 ? nearestDouble(range.upper) : -nearestDouble(range.lower);
          limit.shift = -sign * referencePart(&RobustProblem::Parameter::input_shift, i);
          limits_.push_back(std::move(limit));
        }
      }
    }
    if (problem_.invariance != InvarianceRule::kNone) listInvariance();
  }

  void listInvariance() {
    const std::vector<int> errors = problem_.errorParameters();
    const bool shifted = problem_.stack == Stack::kShift;
    const int first = shifted ? 0 : 1;
    const int block = problem_.invariance == InvarianceRule::kTerminal ? N_ - 1 : first;
    for (const ExactHalfSpace& half_space : invariantParameters(problem_).rows) {
      Limit limit = noLimit();
      limit.bound = nearestDouble(half_space.b);
      for (int i = 0; i < nx_; ++i) limit.x[block * nx_ + i] = nearestDouble(half_space.a[at(errors[at(i)])]);
      for (int j = 0; j < np_; ++j) {
        if (problem_.parameters[at(j)].state < 0) limit.shift[j] = -nearestDouble(half_space.a[at(j)]);
      }
      limits_.push_back(std::move(limit));
    }
  }

  void number() {
    feedback_ = N_ * nu_;
    tau_ = feedback_ + nu_ * nw_ * N_ * (N_ - 1) / 2;
    gamma_ = tau_ + 1;
    omega_ = gamma_ + N_ * ny_ * N_ * nw_;
    count_ = omega_ + static_cast<int>(limits_.size()) * N_ * nw_;
  }

  // entry of z that is L_{k,i}, input row r, channel c; i < k
  int feedbackEntry(int k, int i, int r, int c) const {
    return feedback_ + (k * (k - 1) / 2 + i) * nu_ * nw_ + r * nw_ + c;
  }

  void add(VectorXd row, double bound, VectorXd shift) {
    rows_.push_back(std::move(row));
    bounds_.push_back(bound);
    shifts_.push_back(std::move(shift));
  }

  // How direction . (X, U) reacts to disturbance c of step i: a constant and coefficients of z.
  std::pair<double, VectorXd> reaction(const VectorXd& x, const VectorXd& u, int i, int c) const {
    VectorXd row = VectorXd::Zero(count_);
    const VectorXd through = model_.B.transpose() * x + u;
    for (int k = i + 1; k < N_; ++k) {
      for (int r = 0; r < nu_; ++r) row[feedbackEntry(k, i, r, c)] = through[k * nu_ + r];
    }
    return {model_.G.col(i * nw_ + c).dot(x), std::move(row)};
  }

  // The nominal part, plus one bounding variable for each disturbance; its two-sided bound (Eq. 27 to 33).
  void addWorstCase(const VectorXd& x, const VectorXd& u, int variables, bool with_tau, double bound,
                    const VectorXd& shift) {
    const std::vector<int> errors = problem_.errorParameters();
    VectorXd row = VectorXd::Zero(count_);
    row.head(N_ * nu_) = model_.B.transpose() * x + u;
    row.segment(variables, N_ * nw_).setOnes();
    if (with_tau) row[tau_] = -1.0;
    VectorXd right = shift;
    const VectorXd through = model_.A.transpose() * x;
    for (int i = 0; i < nx_; ++i) right[errors[at(i)]] -= through[i];
    add(std::move(row), bound - model_.drift.dot(x), std::move(right));
  }

  void addBounding(const VectorXd& x, const VectorXd& u, int variables) {
    for (int i = 0; i < N_; ++i) {
      for (int c = 0; c < nw_; ++c) {
        const auto [constant, coefficients] = reaction(x, u, i, c);
        for (const double sign : {1.0, -1.0}) {
          VectorXd row = sign * coefficients;
          row[variables + i * nw_ + c] = -1.0;
          add(std::move(row), -sign * constant, VectorXd::Zero(np_));
        }
      }
    }
  }

  void addPeaks() {
    const MatrixXd C = toDoubles(problem_.C);
    const VectorXd no_input = VectorXd::Zero(N_ * nu_);
    for (int block = 0; block < N_; ++block) {
      for (int i = 0; i < ny_; ++i) {
        VectorXd x = VectorXd::Zero(N_ * nx_);
        x.segment(block * nx_, nx_) = C.row(i);
        const int variables = gamma_ + (block * ny_ + i) * N_ * nw_;
        for (const double sign : {1.0, -1.0})
          addWorstCase(sign * x, no_input, variables, true, 0.0, VectorXd::Zero(np_));
        addBounding(x, no_input, variables);
      }
    }
  }

  void addLimits() {
    for (std::size_t k = 0; k < limits_.size(); ++k) {
      const Limit& limit = limits_[k];
      const int variables = omega_ + static_cast<int>(k) * N_ * nw_;
      addWorstCase(limit.x, limit.u, variables, false, limit.bound, limit.shift);
      addBounding(limit.x, limit.u, variables);
    }
  }

  // K (A + B K)^(k-1-i) G, or zero
  void addFeedback() {
    if (problem_.feedback == FeedbackPrediction::kFree) return;
    const MatrixXd A = toDoubles(problem_.A), B = toDoubles(problem_.B), G = toDoubles(problem_.G);
    MatrixXd K = MatrixXd::Zero(nu_, nx_);
    if (problem_.feedback == FeedbackPrediction::kFixed) K = toDoubles(problem_.feedback_gain);
    for (int i = 0; i < N_; ++i) {
      MatrixXd reaction = G;
      for (int k = i + 1; k < N_; ++k) {
        for (int r = 0; r < nu_; ++r) {
          for (int c = 0; c < nw_; ++c) {
            for (const double sign : {1.0, -1.0}) {
              VectorXd row = VectorXd::Zero(count_);
              row[feedbackEntry(k, i, r, c)] = sign;
              add(std::move(row), sign * K.row(r).dot(reaction.col(c)), VectorXd::Zero(np_));
            }
          }
        }
        reaction = ((A + B * K) * reaction).eval();
      }
    }
  }

  void addSigns() {
    for (int j = tau_; j < count_; ++j) {
      VectorXd row = VectorXd::Zero(count_);
      row[j] = -1.0;
      add(std::move(row), j == tau_ ? -nearestDouble(problem_.floor) : 0.0, VectorXd::Zero(np_));
    }
  }

  const RobustProblem& problem_;
  StackedModel model_;
  int nx_, nu_, nw_, ny_, N_, np_;
  int feedback_ = 0, tau_ = 0, gamma_ = 0, omega_ = 0, count_ = 0;
  std::vector<Limit> limits_;
  std::vector<VectorXd> rows_;
  std::vector<double> bounds_;
  std::vector<VectorXd> shifts_;
};

}  // namespace

FullProgram buildFullProgram(const RobustProblem& problem) { return FullBuilder(problem).build(); }

}  // namespace polyfly
