#include "mpc_core/observer.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

void require(bool holds, const std::string& field, const std::string& rule) {
  if (!holds) throw Error("observer: " + field + ": " + rule);
}

void checkOptions(const ObserverOptions& options, int states) {
  const auto positive = [](double value) { return std::isfinite(value) && value > 0.0; };
  require(positive(options.period), "period", "must be greater than 0");
  require(positive(options.disturbance), "disturbance", "must be greater than 0");
  for (int i = 0; i < states; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const std::string entry = "[" + std::to_string(i) + "]";
    require(positive(options.measurement[index]), "measurement" + entry, "must be greater than 0");
    require(std::isfinite(options.process[index]) && options.process[index] >= 0.0, "process" + entry,
            "must be 0 or more");
  }
}

/// L of the filter form: minus the steady-state Kalman gain for the output [I 0], by the dual Riccati
/// equation.
Eigen::MatrixXd kalmanGain(const Eigen::MatrixXd& transition, const ObserverOptions& options) {
  const Eigen::Index size = transition.rows();
  const Eigen::Index nx = size - 1;
  const Eigen::MatrixXd C = Eigen::MatrixXd::Identity(nx, size);
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd V = Eigen::MatrixXd::Zero(nx, nx);
  for (Eigen::Index i = 0; i < nx; ++i) {
    const auto index = static_cast<std::size_t>(i);
    W(i, i) = options.process[index] * options.process[index];
    V(i, i) = options.measurement[index] * options.measurement[index];
  }
  W(nx, nx) = options.disturbance * options.disturbance;
  const Eigen::MatrixXd P = solveRiccati(transition.transpose(), C.transpose(), W, V);
  const Eigen::MatrixXd S = C * P * C.transpose() + V;
  return -S.ldlt().solve(C * P).transpose();
}

}  // namespace

DisturbanceObserver::DisturbanceObserver(const MpcProblem& problem, const ObserverOptions& options)
    : state_count_(problem.stateCount()) {
  require(state_count_ >= 1 && state_count_ <= kMaxStates, problem.name, "must have 1 to 4 states");
  require(problem.inputCount() == 1, problem.name, "must have one input");
  require(problem.Bd_c.cols() == 1, problem.name, "must have one disturbance");
  checkOptions(options, state_count_);
  const DiscreteModel model = discretise(problem, options.period);
  const Eigen::Index nx = state_count_;
  Eigen::MatrixXd transition = Eigen::MatrixXd::Identity(nx + 1, nx + 1);
  transition.topLeftCorner(nx, nx) = model.A;
  transition.topRightCorner(nx, 1) = model.Bd;
  Eigen::MatrixXd gain;
  try {
    gain = kalmanGain(transition, options);
  } catch (const Error& error) {
    throw Error("observer: " + problem.name + ": no stable observer: " + error.what());
  }
  for (Eigen::Index row = 0; row <= nx; ++row) {
    const auto r = static_cast<std::size_t>(row);
    input_[r] = row < nx ? model.B(row, 0) : 0.0;
    for (Eigen::Index col = 0; col <= nx; ++col)
      transition_[r][static_cast<std::size_t>(col)] = transition(row, col);
    for (Eigen::Index col = 0; col < nx; ++col) gain_[r][static_cast<std::size_t>(col)] = gain(row, col);
  }
}

void DisturbanceObserver::transferState(const DisturbanceObserver& other) noexcept {
  if (state_count_ != other.state_count_) return;
  estimate_ = other.estimate_;
  started_ = other.started_;
}

void DisturbanceObserver::reset() noexcept {
  estimate_.fill(0.0);
  started_ = false;
}

void DisturbanceObserver::setDisturbance(double disturbance) noexcept {
  if (std::isfinite(disturbance)) estimate_[static_cast<std::size_t>(state_count_)] = disturbance;
}

void DisturbanceObserver::update(const double* y, const double* u_previous, int periods) noexcept {
  bool finite = std::isfinite(*u_previous);
  for (int i = 0; i < state_count_; ++i) finite = finite && std::isfinite(y[i]);
  if (!finite) return;
  if (!started_ || periods > kMaxPeriods) {
    std::copy(y, y + state_count_, estimate_.begin());
    started_ = true;
    return;
  }
  for (int period = 0; period < std::max(periods, 1); ++period) predict(*u_previous);
  correct(y);
}

void DisturbanceObserver::predict(double u) noexcept {
  const auto size = static_cast<std::size_t>(state_count_) + 1;
  Vector next{};
  for (std::size_t row = 0; row < size; ++row) {
    next[row] = input_[row] * u;
    for (std::size_t col = 0; col < size; ++col) next[row] += transition_[row][col] * estimate_[col];
  }
  estimate_ = next;
}

void DisturbanceObserver::correct(const double* y) noexcept {
  const auto nx = static_cast<std::size_t>(state_count_);
  Vector innovation{};  // predicted minus measured, as in Eq. 5
  for (std::size_t i = 0; i < nx; ++i) innovation[i] = estimate_[i] - y[i];
  for (std::size_t row = 0; row <= nx; ++row) {
    for (std::size_t col = 0; col < nx; ++col) estimate_[row] += gain_[row][col] * innovation[col];
  }
}

Eigen::MatrixXd DisturbanceObserver::gain() const {
  Eigen::MatrixXd gain(state_count_ + 1, state_count_);
  for (int row = 0; row <= state_count_; ++row) {
    for (int col = 0; col < state_count_; ++col) {
      gain(row, col) = gain_[static_cast<std::size_t>(row)][static_cast<std::size_t>(col)];
    }
  }
  return gain;
}

}  // namespace polyfly
