#include <cmath>

#include "core/text.hpp"
#include "problem/optimal_control.hpp"

namespace checker {
namespace {

/// What theta says, as matrices on (theta, 1).
struct Given {
  /// e_0, u_ref, x_ref, and u_{-1} - u_ref, which the first input is compared with.
  BallMatrix error, input_reference, state_reference, before;
  /// e_{k+1} = A e_k + B u~_k + drift
  BallMatrix drift;
};

/// Columns of the parameters with one role; fixed ones count in the last column.
BallMatrix columnsOf(const TrackingProblem& problem, TrackingProblem::Role role, std::size_t rows) {
  const std::size_t p = problem.freeCount();
  BallMatrix result(rows, p + 1);
  std::size_t column = 0;
  for (const TrackingProblem::Parameter& parameter : problem.parameters) {
    if (parameter.role == role) {
      Ball& entry = result.at(parameter.index, parameter.fixed ? p : column);
      entry += parameter.fixed ? Ball(mpq_class(*parameter.fixed)) : Ball(1);
    }
    if (!parameter.fixed) ++column;
  }
  return result;
}

bool hasRole(const TrackingProblem& problem, TrackingProblem::Role role, std::size_t index) {
  for (const TrackingProblem::Parameter& parameter : problem.parameters) {
    if (parameter.role == role && parameter.index == index) return true;
  }
  return false;
}

/// Eq. 6: (A - I) x_ref + B u_ref = -B_d d, C x_ref = r.
void setSteadyState(const TrackingProblem& problem, const DiscreteSystem& system, const BallMatrix& r,
                    const BallMatrix& d, Given& given) {
  const std::size_t nx = system.A.rows(), nu = system.B.columns();
  BallMatrix matrix(nx + nu, nx + nu), right(nx + nu, r.columns());
  matrix.setBlock(0, 0, system.A - BallMatrix::identity(nx));
  matrix.setBlock(0, nx, system.B);
  matrix.setBlock(nx, 0, problem.C);
  right.setBlock(0, 0, BallMatrix(nx, r.columns()) - system.B_d * d);
  right.setBlock(nx, 0, r);
  const BallMatrix steady = solved(matrix, right);
  given.state_reference = steady.block(0, 0, nx, r.columns());
  given.input_reference = steady.block(nx, 0, nu, r.columns());
}

Given givenBy(const TrackingProblem& problem, const DiscreteSystem& system) {
  using Role = TrackingProblem::Role;
  const std::size_t nx = system.A.rows(), nu = system.B.columns();
  Given given;
  const BallMatrix d = columnsOf(problem, Role::kDisturbance, system.B_d.columns());
  if (hasRole(problem, Role::kState, 0)) {
    setSteadyState(problem, system, columnsOf(problem, Role::kReference, nu), d, given);
    given.error = columnsOf(problem, Role::kState, nx) - given.state_reference;
    given.drift = BallMatrix(nx, d.columns());
  } else {
    given.error = columnsOf(problem, Role::kError, nx);
    given.input_reference = columnsOf(problem, Role::kInputReference, nu);
    given.state_reference = columnsOf(problem, Role::kStateReference, nx);
    given.drift = system.B_d * d;
  }
  given.before = columnsOf(problem, Role::kPreviousInput, nu) - given.input_reference;
  for (std::size_t i = 0; i < nu; ++i) {
    if (!hasRole(problem, Role::kPreviousInput, i))
      given.before.setBlock(i, 0, BallMatrix(1, given.before.columns()));
  }
  return given;
}

/// v = on_z z + on_theta (theta, 1)
struct Affine {
  BallMatrix on_z, on_theta;
};

Affine operator+(const Affine& a, const Affine& b) { return {a.on_z + b.on_z, a.on_theta + b.on_theta}; }
Affine operator-(const Affine& a, const Affine& b) { return {a.on_z - b.on_z, a.on_theta - b.on_theta}; }
Affine operator*(const BallMatrix& M, const Affine& a) { return {M * a.on_z, M * a.on_theta}; }

class Condensing {
 public:
  Condensing(const TrackingProblem& problem, Variables variables)
      : problem_(problem),
        variables_(variables),
        system_(discretised(problem)),
        given_(givenBy(problem, system_)),
        nu_(problem.inputs.size()),
        inputs_(problem.blocks.size() * nu_),
        n_(inputs_ + slackCount(problem)),
        p_(problem.freeCount()),
        on_z_(n_, n_),
        on_theta_(n_, p_ + 1) {}

  ExpectedProgram run() {
    BallMatrix P;
    if (problem_.P) {
      P = *problem_.P;
    } else {
      const TerminalWeight terminal = terminalWeight(system_, problem_.Q, problem_.R);
      P = terminal.P;
      result_.riccati_residual = terminal.residual;
    }
    predict(P);
    const std::size_t N = inputs_of_stage_.size();
    for (std::size_t k = 0; k < N; ++k) {
      addCost(errors_[k], problem_.Q);
      addCost(inputs_of_stage_[k], problem_.R);
      addCost(inputs_of_stage_[k] - (k == 0 ? before() : inputs_of_stage_[k - 1]), problem_.R_delta);
      addRanges(errors_[k + 1], problem_.states);
    }
    addCost(errors_[N], P);
    for (std::size_t block = 0; block < problem_.blocks.size(); ++block) addInput(block);
    addTerminalSet();
    for (const TrackingProblem::Constraint& constraint : problem_.constraints) addConstraint(constraint);
    result_.H = on_z_ + on_z_;
    result_.F = on_theta_ + on_theta_;
    for (const auto& [place, weight] : linear_) result_.F.at(place, p_) += Ball(mpq_class(weight));
    result_.C = given_.input_reference + inputs_of_stage_.front().on_theta;
    return result_;
  }

 private:
  static std::size_t slackCount(const TrackingProblem& problem) {
    std::size_t stages = 0, count = 0;
    for (const std::size_t length : problem.blocks) stages += length;
    for (const TrackingProblem::Constraint& constraint : problem.constraints) {
      if (constraint.is_soft) count += constraint.shares_slack ? 1 : stages;
    }
    return count;
  }

  void predict(const BallMatrix& P) {
    std::vector<BallMatrix> gains;
    if (variables_ == Variables::kBesideFeedback) gains = feedbackGains(problem_, system_, P);
    errors_.push_back({BallMatrix(system_.A.rows(), n_), given_.error});
    const Affine drift{BallMatrix(system_.A.rows(), n_), given_.drift};
    for (std::size_t block = 0; block < problem_.blocks.size(); ++block) {
      Affine input{BallMatrix(nu_, n_), BallMatrix(nu_, p_ + 1)};
      input.on_z.setBlock(0, block * nu_, BallMatrix::identity(nu_));
      for (std::size_t k = 0; k < problem_.blocks[block]; ++k) {
        if (!gains.empty()) input = input - fedBack(gains[block]);
        inputs_of_stage_.push_back(input);
        errors_.push_back(system_.A * errors_.back() + system_.B * input + drift);
      }
    }
  }

  /// K (e_k, u~_{k-1}) of the next stage.
  Affine fedBack(const BallMatrix& K) const {
    const std::size_t nx = system_.A.rows();
    const Affine last = inputs_of_stage_.empty() ? before() : inputs_of_stage_.back();
    return K.block(0, 0, nu_, nx) * errors_.back() + K.block(0, nx, nu_, nu_) * last;
  }

  Affine before() const { return {BallMatrix(nu_, n_), given_.before}; }

  /// v'W v, without what does not depend on z.
  void addCost(const Affine& v, const BallMatrix& weight) {
    const BallMatrix left = v.on_z.transposed() * weight;
    on_z_ = on_z_ + left * v.on_z;
    on_theta_ = on_theta_ + left * v.on_theta;
  }

  /// Row i of sign v <= bound, without an entry for an infinite bound. Returns the row.
  ExpectedRow* addRow(const Affine& v, std::size_t i, int sign, double bound) {
    if (!std::isfinite(bound)) return nullptr;
    ExpectedRow row;
    const Ball factor(sign);
    for (std::size_t j = 0; j < n_; ++j) row.on_z.push_back(factor * v.on_z.at(i, j));
    for (std::size_t j = 0; j < p_; ++j) row.on_theta.push_back(-(factor * v.on_theta.at(i, j)));
    row.bound = Ball(mpq_class(bound)) - factor * v.on_theta.at(i, p_);
    result_.rows.push_back(row);
    return &result_.rows.back();
  }

  void addRanges(const Affine& v, const std::vector<TrackingProblem::Range>& ranges) {
    for (std::size_t i = 0; i < ranges.size(); ++i) {
      addRow(v, i, 1, ranges[i].upper);
      addRow(v, i, -1, -ranges[i].lower);
    }
  }

  /// Bounds on u and on its change, once for each block.
  void addInput(std::size_t block) {
    std::size_t stage = 0;
    for (std::size_t k = 0; k < block; ++k) stage += problem_.blocks[k];
    const Affine& input = inputs_of_stage_[stage];
    addRanges(input + Affine{BallMatrix(nu_, n_), given_.input_reference}, problem_.inputs);
    addRanges(input - (stage == 0 ? before() : inputs_of_stage_[stage - 1]), problem_.changes);
  }

  void addTerminalSet() {
    for (std::size_t i = 0; i < problem_.T.rows(); ++i) {
      ExpectedRow* const row = addRow(problem_.T * errors_.back(), i, 1, 0.0);
      row->bound += problem_.t.at(i, 0);
    }
    for (std::size_t i = 0; problem_.ends_at_reference && i < system_.A.rows(); ++i)
      addRow(errors_.back(), i, 1, 0.0)->is_equality = true;
  }

  /// Both sides of a soft bound share a slack, which is at least 0.
  void addConstraint(const TrackingProblem::Constraint& constraint) {
    const std::size_t first = constraint.has_input ? 0 : 1, N = inputs_of_stage_.size();
    std::size_t slack = 0;
    for (std::size_t k = first; k < first + N; ++k) {
      const bool is_new = constraint.is_soft && (k == first || !constraint.shares_slack);
      if (is_new) slack = addSlack(constraint);
      Affine value = constraint.on_x * errors_[k];
      if (constraint.has_input) value = value + constraint.on_u * inputs_of_stage_[k];
      if (constraint.is_absolute)
        value.on_theta = value.on_theta + constraint.on_x * given_.state_reference +
                         constraint.on_u * given_.input_reference;
      for (const int sign : {1, -1}) {
        ExpectedRow* const row =
            addRow(value, 0, sign, sign > 0 ? constraint.range.upper : -constraint.range.lower);
        if (row != nullptr && constraint.is_soft) row->on_z[slack] = Ball(-1);
      }
    }
  }

  /// Its place in z. Without a linear weight it is at least 0 by itself.
  std::size_t addSlack(const TrackingProblem::Constraint& constraint) {
    const std::size_t place = inputs_ + next_slack_++;
    on_z_.at(place, place) += Ball(mpq_class(constraint.quadratic));
    linear_.emplace_back(place, constraint.linear);
    if (constraint.linear == 0.0) return place;
    ExpectedRow floor;
    floor.on_z.resize(n_);
    floor.on_z[place] = Ball(-1);
    floor.on_theta.resize(p_);
    result_.rows.push_back(floor);
    return place;
  }

  const TrackingProblem& problem_;
  const Variables variables_;
  const DiscreteSystem system_;
  const Given given_;
  /// Entries of z: the inputs of the blocks, then slacks; and of theta.
  const std::size_t nu_, inputs_, n_, p_;
  /// e_0 .. e_N and u~_0 .. u~_{N-1}
  std::vector<Affine> errors_, inputs_of_stage_;
  /// The cost is z'on_z z + 2 z'on_theta (theta, 1), and linear terms.
  BallMatrix on_z_, on_theta_;
  std::vector<std::pair<std::size_t, double>> linear_;
  std::size_t next_slack_ = 0;
  ExpectedProgram result_;
};

}  // namespace

ExpectedProgram expectedProgram(const TrackingProblem& problem, Variables variables) {
  if (variables == Variables::kBesideFeedback)
    for (const std::size_t length : problem.blocks)
      require(length == 1, "the inputs of a block follow no feedback");
  return Condensing(problem, variables).run();
}

}  // namespace checker
