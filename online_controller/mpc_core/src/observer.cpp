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
  require(std::isfinite(options.rate) && options.rate >= 0.0, "rate", "must be 0 or more");
  require(positive(options.rate_time), "rate_time", "must be greater than 0");
  for (int i = 0; i < states; ++i) {
    const auto index = static_cast<std::size_t>(i);
    const std::string entry = "[" + std::to_string(i) + "]";
    require(positive(options.measurement[index]), "measurement" + entry, "must be greater than 0");
    require(std::isfinite(options.process[index]) && options.process[index] >= 0.0, "process" + entry,
            "must be 0 or more");
  }
}

/// [A Bd; 0 I], or with a rate of the disturbance [A Bd 0; 0 1 T(1 - e); 0 0 e], where e is what a period leaves of it.
Eigen::MatrixXd transitionOf(const DiscreteModel& model, const ObserverOptions& options) {
  const Eigen::Index nx = model.A.rows();
  const Eigen::Index size = nx + (options.rate > 0.0 ? 2 : 1);
  Eigen::MatrixXd transition = Eigen::MatrixXd::Identity(size, size);
  transition.topLeftCorner(nx, nx) = model.A;
  transition.block(0, nx, nx, 1) = model.Bd;
  if (options.rate > 0.0) {
    const double left = std::exp(-options.period / options.rate_time);
    transition(nx, nx + 1) = options.rate_time * (1.0 - left);
    transition(nx + 1, nx + 1) = left;
  }
  return transition;
}

/// L of the filter form, and the covariance of its innovations.
struct SteadyFilter {
  Eigen::MatrixXd gain, innovation;
};

/// L is minus the steady-state Kalman gain for the output [I 0] of nx states, by the dual Riccati equation.
SteadyFilter steadyFilter(const Eigen::MatrixXd& transition, Eigen::Index nx,
                          const ObserverOptions& options) {
  const Eigen::Index size = transition.rows();
  const Eigen::MatrixXd C = Eigen::MatrixXd::Identity(nx, size);
  Eigen::MatrixXd W = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd V = Eigen::MatrixXd::Zero(nx, nx);
  for (Eigen::Index i = 0; i < nx; ++i) {
    const auto index = static_cast<std::size_t>(i);
    W(i, i) = options.process[index] * options.process[index];
    V(i, i) = options.measurement[index] * options.measurement[index];
  }
  W(nx, nx) = options.disturbance * options.disturbance;
  if (size > nx + 1) W(nx + 1, nx + 1) = options.rate * options.rate;
  const Eigen::MatrixXd P = solveRiccati(transition.transpose(), C.transpose(), W, V);
  const Eigen::MatrixXd S = C * P * C.transpose() + V;
  return {-S.ldlt().solve(C * P).transpose(), S};
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
  const Eigen::MatrixXd transition = transitionOf(model, options);
  const Eigen::Index size = transition.rows();
  size_ = static_cast<int>(size);
  SteadyFilter filter;
  try {
    filter = steadyFilter(transition, nx, options);
  } catch (const Error& error) {
    throw Error("observer: " + problem.name + ": no stable observer: " + error.what());
  }
  for (Eigen::Index row = 0; row < size; ++row) {
    const auto r = static_cast<std::size_t>(row);
    input_[r] = row < nx ? model.B(row, 0) : 0.0;
    for (Eigen::Index col = 0; col < size; ++col)
      transition_[r][static_cast<std::size_t>(col)] = transition(row, col);
    for (Eigen::Index col = 0; col < nx; ++col)
      gain_[r][static_cast<std::size_t>(col)] = filter.gain(row, col);
    if (row < nx) innovation_variance_[r] = filter.innovation(row, row);
  }
}

void DisturbanceObserver::transferState(const DisturbanceObserver& other) noexcept {
  if (state_count_ != other.state_count_) return;
  estimate_ = other.estimate_;
  innovation_ = other.innovation_;
  if (size_ == state_count_ + 1) setDisturbance(disturbance());
  started_ = other.started_;
}

void DisturbanceObserver::reset() noexcept {
  estimate_.fill(0.0);
  innovation_.fill(0.0);
  started_ = false;
}

void DisturbanceObserver::setDisturbance(double disturbance) noexcept {
  if (!std::isfinite(disturbance)) return;
  estimate_[static_cast<std::size_t>(state_count_)] = disturbance;
  estimate_[static_cast<std::size_t>(state_count_) + 1] = 0.0;
}

void DisturbanceObserver::move(double share, const DisturbanceObserver& along) noexcept {
  for (std::size_t i = 0; i < static_cast<std::size_t>(size_); ++i)
    estimate_[i] += share * along.estimate_[i];
}

void DisturbanceObserver::update(const double* y, const double* u_previous, int periods,
                                 double known) noexcept {
  bool finite = std::isfinite(*u_previous) && std::isfinite(known);
  for (int i = 0; i < state_count_; ++i) finite = finite && std::isfinite(y[i]);
  if (!finite) return;
  if (!started_ || periods > kMaxPeriods) {
    std::copy(y, y + state_count_, estimate_.begin());
    setDisturbance(disturbance());
    innovation_.fill(0.0);
    started_ = true;
    return;
  }
  for (int period = 0; period < std::max(periods, 1); ++period) predict(*u_previous, known);
  correct(y);
}

void DisturbanceObserver::predict(double u, double known) noexcept {
  const auto size = static_cast<std::size_t>(size_);
  const auto disturbance = static_cast<std::size_t>(state_count_);
  Vector next{};
  for (std::size_t row = 0; row < size; ++row) {
    next[row] = input_[row] * u;
    for (std::size_t col = 0; col < size; ++col) next[row] += transition_[row][col] * estimate_[col];
    if (row < disturbance) next[row] += transition_[row][disturbance] * known;
  }
  estimate_ = next;
}

void DisturbanceObserver::correct(const double* y) noexcept {
  const auto nx = static_cast<std::size_t>(state_count_);
  for (std::size_t i = 0; i < nx; ++i) innovation_[i] = estimate_[i] - y[i];  // as in Eq. 5
  for (std::size_t row = 0; row < static_cast<std::size_t>(size_); ++row) {
    for (std::size_t col = 0; col < nx; ++col) estimate_[row] += gain_[row][col] * innovation_[col];
  }
}

Eigen::MatrixXd DisturbanceObserver::gain() const {
  Eigen::MatrixXd gain(size_, state_count_);
  for (int row = 0; row < size_; ++row) {
    for (int col = 0; col < state_count_; ++col) {
      gain(row, col) = gain_[static_cast<std::size_t>(row)][static_cast<std::size_t>(col)];
    }
  }
  return gain;
}

}  // namespace polyfly
