#include "nonlinear_mpc/nonlinear_mpc.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/range_check.hpp"

namespace polyfly {
namespace {

constexpr int kNx = kMultirotorStates;
constexpr int kNu = kMultirotorInputs;
// The velocity among the states.
constexpr int kVelocity = 3;
// Of the l1 relaxation of the velocity's limit [s/m].
constexpr double kSpeedPenalty = 1e5;

void require(bool holds, const std::string& rule) {
  if (!holds) throw Error(rule);
}

const NonlinearMpcOptions& checked(const NonlinearMpcOptions& options) {
  visitNonlinearOptions(options, RangeCheck{});
  require((options.position_weight.array() > 0.0).all(),
          "nonlinear/position_weight_x .. z: must be above 0: without them nothing brings the vehicle back");
  require(options.model.gravity > 0.0 && options.model.gravity < 100.0,
          "vehicle/gravity: must be above 0 and below 100 m/s^2");
  require(options.angle_max > 0.0 && options.angle_max < 1.4,
          "controller/angle_max: must be above 0 and below 1.4 rad");
  require(options.thrust_min > 0.0 && options.thrust_min < options.thrust_max,
          "controller/thrust_min, thrust_max: must increase and be above 0");
  return options;
}

std::size_t size(int a, int b) { return static_cast<std::size_t>(a) * static_cast<std::size_t>(b); }

}  // namespace

NonlinearMpc::NonlinearMpc(const NonlinearMpcOptions& options)
    : options_(checked(options)), condensing_(options.horizon), qp_(kNu * options.horizon, rowCount()) {
  const int N = options_.horizon;
  const int n = kNu * N;
  const int m = rowCount();
  state_weight_ << options_.position_weight, options_.velocity_weight, options_.roll_weight,
      options_.pitch_weight;
  transitions_.resize(static_cast<std::size_t>(N));
  inputs_.assign(static_cast<std::size_t>(N), MultirotorInput(0.0, 0.0, options_.model.gravity));
  states_.assign(static_cast<std::size_t>(N + 1), MultirotorState::Zero());
  deviations_ = states_;
  for (AlignedArray* array : {&g_, &lower_, &upper_}) *array = AlignedArray(static_cast<std::size_t>(n));
  rows_ = AlignedArray(size(m, n));
  for (AlignedArray* array : {&row_lower_, &row_upper_}) *array = AlignedArray(static_cast<std::size_t>(m));
  if (options_.working_sets_max > 0) qp_.setIterationLimit(options_.working_sets_max);
  for (int i = 0; i < m; ++i) qp_.setPenalty(i, kSpeedPenalty);
  computeTerminalWeight();
}

void NonlinearMpc::computeTerminalWeight() {
  StageStep hover;
  const double gravity = options_.model.gravity;
  integrateStage(options_.model, options_.period, {}, MultirotorState::Zero(), {0.0, 0.0, gravity}, hover);
  const Eigen::MatrixXd Q = state_weight_.asDiagonal();
  const Eigen::Vector3d R(options_.roll_command_weight, options_.pitch_command_weight,
                          options_.thrust_weight);
  hover_weight_ = solveRiccati(hover.A, hover.B, Q, R.asDiagonal());
}

void NonlinearMpc::start(const MultirotorState& x, const MultirotorInput& u,
                         const StageConditions* stages) noexcept {
  StageStep step;
  states_[0] = x;
  for (int k = 0; k < options_.horizon; ++k) {
    const auto i = static_cast<std::size_t>(k);
    inputs_[i] = u;
    integrateStage(options_.model, options_.period, stages[k], states_[i], u, step);
    states_[i + 1] = step.next;
  }
}

bool NonlinearMpc::transferState(const NonlinearMpc& other) noexcept {
  if (options_.horizon != other.options_.horizon || options_.period != other.options_.period) return false;
  std::copy(other.states_.begin(), other.states_.end(), states_.begin());
  std::copy(other.inputs_.begin(), other.inputs_.end(), inputs_.begin());
  return true;
}

void NonlinearMpc::shift(double share) noexcept {
  const std::size_t N = transitions_.size();
  for (std::size_t k = 0; k + 1 < N; ++k) inputs_[k] += share * (inputs_[k + 1] - inputs_[k]);
  const MultirotorState beyond = states_[N] + (states_[N] - states_[N - 1]);
  for (std::size_t k = 0; k <= N; ++k) {
    states_[k] += share * ((k < N ? states_[k + 1] : beyond) - states_[k]);
  }
}

bool NonlinearMpc::prepare(const StageConditions* stages) noexcept {
  linearise(stages);
  const StageConditions& last = stages[options_.horizon - 1];
  weighEnd(last.yaw + options_.period * last.yaw_rate);
  condensing_.condense();
  if (rowCount() > 0) setSoftRows();
  return qp_.setHessian(condensing_.hessian());
}

void NonlinearMpc::linearise(const StageConditions* stages) noexcept {
  StageStep step;
  for (int k = 0; k < options_.horizon; ++k) {
    const auto i = static_cast<std::size_t>(k);
    integrateStage(options_.model, options_.period, stages[k], states_[i], inputs_[i], step);
    condensing_.stages()[i].A = step.A;
    condensing_.stages()[i].B = step.B;
    transitions_[i].defect = step.next - states_[i + 1];
    weigh(k);
  }
}

// The weights of stage k; that of the lift z_B T depends on tilt and thrust.
void NonlinearMpc::weigh(int k) noexcept {
  const MultirotorState& x = state(k);
  const double thrust = input(k)(2);
  const double sr = std::sin(x(6)), cr = std::cos(x(6));
  const double sp = std::sin(x(7)), cp = std::cos(x(7));
  Transition& transition = transitions_[static_cast<std::size_t>(k)];
  transition.lift = cp * cr * thrust;
  transition.lift_slope = {-cp * sr * thrust, -sp * cr * thrust, cp * cr};
  auto& weight = condensing_.stages()[static_cast<std::size_t>(k)].weight;
  weight.setZero();
  weight.diagonal() << state_weight_, options_.roll_command_weight, options_.pitch_command_weight, 0.0;
  constexpr int kOn[] = {kNx - 2, kNx - 1, kNx + kNu - 1};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j)
      weight(kOn[i], kOn[j]) += options_.thrust_weight * transition.lift_slope(i) * transition.lift_slope(j);
  }
}

void NonlinearMpc::weighEnd(double yaw) noexcept {
  Condensing::StateMatrix turn = Condensing::StateMatrix::Identity();
  const double cosine = std::cos(yaw);
  const double sine = std::sin(yaw);
  for (const int i : {0, 3}) turn.block<2, 2>(i, i) << cosine, sine, -sine, cosine;
  condensing_.terminalWeight().noalias() = turn.transpose() * (hover_weight_ * turn).eval();
}

void NonlinearMpc::setSoftRows() noexcept {
  const int m = rowCount();
  int index = 0;
  for (int k = 1; k <= options_.horizon; ++k) {
    for (int i = 0; i < 3; ++i) {
      const double* row = condensing_.sensitivity(k, kVelocity + i);
      for (int j = 0; j < kNu * k; ++j) rows_[j * m + index] = row[j];
      ++index;
    }
  }
  qp_.setRows(rows_.data());
}

QpStatus NonlinearMpc::feedback(const MultirotorState& x, const StageReference* references) noexcept {
  propagate(x - states_[0]);
  computeGradient(references);
  for (int k = 0; k < options_.horizon; ++k) {
    const MultirotorInput& u = input(k);
    for (int i = 0; i < 2; ++i) {
      lower_[kNu * k + i] = -options_.angle_max - u(i);
      upper_[kNu * k + i] = options_.angle_max - u(i);
    }
    lower_[kNu * k + 2] = options_.thrust_min - u(2);
    upper_[kNu * k + 2] = options_.thrust_max - u(2);
  }
  const QpStatus status = qp_.solve(
      {g_.data(), lower_.data(), upper_.data(), row_lower_.data(), row_upper_.data()}, qp_.activeSet());
  if (status == QpStatus::kOptimal) expand(1.0);
  if (status == QpStatus::kIterationLimit) {
    const double share = shareOfStep();
    step_length_ = 0.0;
    if (share > 0.0) expand(share);
  }
  return status;
}

// The point of a search that was ended early lies within the bounds, and so does the solution of the step
// before, moved on, which is the origin: the least cost on the way between them.
double NonlinearMpc::shareOfStep() const noexcept {
  const int n = kNu * options_.horizon;
  const double* x = qp_.x();
  double slope = 0.0, curvature = 0.0;
  for (int j = 0; j < n; ++j) {
    // Column of the lower triangle.
    const double* column = condensing_.hessian() + static_cast<std::ptrdiff_t>(j) * n;
    double product = 0.5 * column[j] * x[j];
    for (int i = j + 1; i < n; ++i) product += column[i] * x[i];
    slope += g_[j] * x[j];
    curvature += 2.0 * x[j] * product;
  }
  if (!(slope < 0.0 && curvature > 0.0)) return 0.0;
  const double share = std::min(1.0, -slope / curvature);
  const double cost = share * slope + 0.5 * share * share * curvature + costOfRows(share);
  return cost <= costOfRows(0.0) ? share : 0.0;
}

// The penalty of the relaxed limits with this share of the step.
double NonlinearMpc::costOfRows(double share) const noexcept {
  const int n = kNu * options_.horizon;
  const int m = rowCount();
  const double* const x = qp_.x();
  double cost = 0.0;
  for (int i = 0; i < m; ++i) {
    double along = 0.0;
    for (int j = 0; j < n; ++j) along += rows_[static_cast<std::ptrdiff_t>(j) * m + i] * x[j];
    cost += kSpeedPenalty * std::max({0.0, row_lower_[i] - share * along, share * along - row_upper_[i]});
  }
  return cost;
}

// How the states deviate from the solution when the inputs stay.
void NonlinearMpc::propagate(const MultirotorState& deviation) noexcept {
  deviations_[0] = deviation;
  for (std::size_t k = 0; k < transitions_.size(); ++k)
    deviations_[k + 1] = condensing_.stages()[k].A * deviations_[k] + transitions_[k].defect;
  for (int row = 0; row < rowCount(); ++row) {
    const auto next = static_cast<std::size_t>(1 + row / 3);
    const int state = kVelocity + row % 3;
    const double value = states_[next](state) + deviations_[next](state);
    row_lower_[row] = -options_.speed_max - value;
    row_upper_[row] = options_.speed_max - value;
  }
}

void NonlinearMpc::computeGradient(const StageReference* references) noexcept {
  const int N = options_.horizon;
  const auto error = [&](int k) {
    const StageReference& reference = references[k];
    MultirotorState target;
    target << reference.position, reference.velocity, reference.roll, reference.pitch;
    return MultirotorState(states_[static_cast<std::size_t>(k)] + deviations_[static_cast<std::size_t>(k)] -
                           target);
  };
  MultirotorState adjoint = condensing_.terminalWeight() * error(N);
  for (int k = N - 1; k >= 0; --k) {
    const Condensing::Stage& stage = condensing_.stages()[static_cast<std::size_t>(k)];
    const Transition& transition = transitions_[static_cast<std::size_t>(k)];
    const MultirotorInput& u = inputs_[static_cast<std::size_t>(k)];
    const Eigen::Vector2d tilt = deviations_[static_cast<std::size_t>(k)].tail<2>();
    const double lift = options_.thrust_weight *
                        (transition.lift + transition.lift_slope.head<2>().dot(tilt) - references[k].lift);
    Eigen::Map<Eigen::Vector3d> g(g_.data() + kNu * k);
    g.noalias() = stage.B.transpose() * adjoint;
    g(0) += options_.roll_command_weight * (u(0) - references[k].roll_command);
    g(1) += options_.pitch_command_weight * (u(1) - references[k].pitch_command);
    g(2) += lift * transition.lift_slope(2);
    adjoint = (stage.A.transpose() * adjoint + state_weight_.cwiseProduct(error(k))).eval();
    adjoint.tail<2>() += lift * transition.lift_slope.head<2>();
  }
}

// The QP's step, or a share of it, on inputs and states.
void NonlinearMpc::expand(double share) noexcept {
  step_length_ = 0.0;
  MultirotorState change = deviations_[0];
  for (std::size_t k = 0; k < transitions_.size(); ++k) {
    const auto at = static_cast<std::ptrdiff_t>(kNu * k);
    const Eigen::Map<const Eigen::Vector3d> least(lower_.data() + at), most(upper_.data() + at);
    const Eigen::Map<const Eigen::Vector3d> whole(qp_.x() + at);
    // Limits may have been changed: then the origin lies beyond them.
    const Eigen::Vector3d du = (share * whole).cwiseMax(least).cwiseMin(most);
    step_length_ = std::max(step_length_, du.cwiseAbs().maxCoeff());
    const Condensing::Stage& stage = condensing_.stages()[k];
    states_[k] += change;
    inputs_[k] += du;
    change = (stage.A * change + stage.B * du + transitions_[k].defect).eval();
  }
  states_.back() += change;
}

}  // namespace polyfly
