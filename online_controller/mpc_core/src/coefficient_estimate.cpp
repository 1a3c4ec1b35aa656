#include "mpc_core/coefficient_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace polyfly {
namespace {

/// The input acts as minus the disturbance does.
MpcProblem drivenByDisturbance(MpcProblem problem) {
  problem.B_c = -problem.Bd_c;
  return problem;
}

}  // namespace

CoefficientEstimate::CoefficientEstimate(const MpcProblem& problem, const ObserverOptions& options, int state,
                                         double deviation)
    : derivative_(drivenByDisturbance(problem), options),
      state_(state),
      greatest_variance_(deviation * deviation),
      forgotten_(greatest_variance_ * options.period / kForgetTime),
      variance_(greatest_variance_) {}

void CoefficientEstimate::update(DisturbanceObserver& observer, double signal, int periods) noexcept {
  constexpr std::array<double, DisturbanceObserver::kMaxStates> kNothing{};
  derivative_.update(kNothing.data(), &signal, periods);
  variance_ = std::min(variance_ + forgotten_ * periods, greatest_variance_);
  // What a change of c adds to the innovation.
  const double slope = derivative_.innovation(state_);
  const double gain =
      variance_ * slope / (slope * slope * variance_ + derivative_.innovationVariance(state_));
  variance_ -= gain * slope * variance_;
  const double before = value_;
  value_ = within(value_ - gain * observer.innovation(state_));
  observer.move(value_ - before, derivative_);
}

double CoefficientEstimate::within(double value) const noexcept {
  constexpr double kMostDeviations = 3.0;
  const double most = kMostDeviations * std::sqrt(greatest_variance_);
  return std::clamp(value, -most, most);
}

void CoefficientEstimate::reset() noexcept {
  derivative_.reset();
  variance_ = greatest_variance_;
  value_ = 0.0;
}

void CoefficientEstimate::transferState(const CoefficientEstimate& other, double more) noexcept {
  derivative_.transferState(other.derivative_);
  variance_ = more == 0.0 ? std::min(other.variance_, greatest_variance_) : greatest_variance_;
  value_ = within(other.value_ + more);
}

}  // namespace polyfly
