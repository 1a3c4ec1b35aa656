#include "online_controller/estimation/force_observer.hpp"

#include <cmath>

namespace polyfly {
namespace {

/// p' = v, v' = a + d: the acceleration is the input.
MpcProblem doubleIntegrator() {
  MpcProblem problem;
  problem.name = "force observer";
  problem.A_c = (Eigen::Matrix2d() << 0.0, 1.0, 0.0, 0.0).finished();
  problem.B_c = Eigen::Vector2d(0.0, 1.0);
  problem.Bd_c = problem.B_c;
  problem.C = Eigen::RowVector2d(1.0, 0.0);
  return problem;
}

ObserverOptions observerOptions(const MultirotorOptions& options, double rate_drift) {
  ObserverOptions observer;
  observer.period = options.control_period;
  observer.process = {std::sqrt(options.noise.q_position), std::sqrt(options.noise.q_velocity), 0.0, 0.0};
  observer.measurement = {std::sqrt(options.noise.r_position), std::sqrt(options.noise.r_velocity), 1.0, 1.0};
  observer.disturbance = options.disturbance_drift;
  observer.rate = rate_drift;
  return observer;
}

DisturbanceObserver makeAxis(const MultirotorOptions& options, double rate_drift) {
  return {doubleIntegrator(), observerOptions(options, rate_drift)};
}

}  // namespace

ForceObserver::ForceObserver(const MultirotorModel& model, const MultirotorOptions& options,
                             double rate_drift, bool finds_drag)
    : model_(model),
      axes_{makeAxis(options, rate_drift), makeAxis(options, rate_drift), makeAxis(options, rate_drift)} {
  if (!finds_drag) return;
  const CoefficientEstimate drag(doubleIntegrator(), observerOptions(options, rate_drift), 1, kDragDeviation);
  drag_ = {drag, drag};
}

Eigen::Vector3d ForceObserver::acceleration(const Eigen::Matrix3d& R, const Eigen::Vector3d& velocity,
                                            double thrust) const noexcept {
  const Eigen::Vector3d in_body = R.transpose() * velocity;
  Eigen::Vector3d result = thrust * R.col(2) - R * model_.drag.cwiseProduct(in_body);
  result.z() -= model_.gravity;
  return result;
}

void ForceObserver::update(const VehicleState& state, double thrust, int periods,
                           const std::optional<Eigen::Vector3d>& followed) noexcept {
  const Eigen::Matrix3d attitude = state.attitude.normalized().toRotationMatrix();
  // The mean of the values at both ends of the period.
  const Eigen::Vector3d now = acceleration(attitude, state.velocity, thrust);
  const Eigen::Vector3d mean =
      started_ ? Eigen::Vector3d(0.5 * (acceleration(last_attitude_, last_velocity_, thrust) + now)) : now;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    const std::array<double, 2> measured{state.position(axis), state.velocity(axis)};
    if (!drag_ || i >= drag_->size()) {
      axes_[i].update(measured.data(), mean.data() + axis, periods);
      continue;
    }
    CoefficientEstimate& drag = (*drag_)[i];
    axes_[i].update(measured.data(), mean.data() + axis, periods, -drag.value() * axes_[i].state()[1]);
    drag.update(axes_[i], followed ? std::optional((*followed)(axis)) : std::nullopt, periods);
  }
  last_attitude_ = attitude;
  last_velocity_ = state.velocity;
  started_ = true;
}

void ForceObserver::transferState(const ForceObserver& other) noexcept {
  for (std::size_t i = 0; i < axes_.size(); ++i) axes_[i].transferState(other.axes_[i]);
  for (std::size_t i = 0; other.drag_ && i < other.drag_->size(); ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    if (drag_) {
      (*drag_)[i].transferState((*other.drag_)[i], other.model_.drag(axis) - model_.drag(axis));
    } else {
      axes_[i].setDisturbance(other.axes_[i].disturbance() - other.drag()(axis) * other.axes_[i].state()[1]);
    }
  }
  last_attitude_ = other.last_attitude_;
  last_velocity_ = other.last_velocity_;
  started_ = other.started_;
}

void ForceObserver::setDisturbance(const Eigen::Vector3d& disturbance) noexcept {
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].setDisturbance(disturbance(static_cast<Eigen::Index>(i)));
  }
  if (!drag_) return;
  for (CoefficientEstimate& drag : *drag_) drag.reset();
}

void ForceObserver::reset() noexcept {
  for (DisturbanceObserver& axis : axes_) axis.reset();
  if (drag_)
    for (CoefficientEstimate& drag : *drag_) drag.reset();
  started_ = false;
}

Eigen::Vector3d ForceObserver::position() const noexcept {
  return {axes_[0].state()[0], axes_[1].state()[0], axes_[2].state()[0]};
}

Eigen::Vector3d ForceObserver::velocity() const noexcept {
  return {axes_[0].state()[1], axes_[1].state()[1], axes_[2].state()[1]};
}

Eigen::Vector3d ForceObserver::disturbance() const noexcept {
  return {axes_[0].disturbance(), axes_[1].disturbance(), axes_[2].disturbance()};
}

Eigen::Vector3d ForceObserver::disturbanceRate() const noexcept {
  return {axes_[0].rate(), axes_[1].rate(), axes_[2].rate()};
}

Eigen::Vector3d ForceObserver::drag() const noexcept {
  return drag_ ? Eigen::Vector3d((*drag_)[0].value(), (*drag_)[1].value(), 0.0) : Eigen::Vector3d::Zero();
}

}  // namespace polyfly
