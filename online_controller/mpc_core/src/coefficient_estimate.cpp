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
      period_(options.period),
      greatest_variance_(deviation * deviation),
      variance_(greatest_variance_) {}

void CoefficientEstimate::update(DisturbanceObserver& observer, std::optional<double> signal,
                                 int periods) noexcept {
  constexpr std::array<double, DisturbanceObserver::kMaxStates> kNothing{};
  const double driven = signal.value_or(0.0);
  derivative_.update(kNothing.data(), &driven, periods);
  const double duration = period_ * periods;
  const double innovation = observer.innovation(state_);
  // What a change of c adds to the innovation.
  const double slope = derivative_.innovation(state_);
  variance_ = std::min(variance_ + greatest_variance_ * duration / kForgetTime, greatest_variance_);
  const double noise = derivative_.innovationVariance(state_);
  const double gain = variance_ * slope / (slope * slope * variance_ + noise);
  variance_ -= gain * slope * variance_;
  const double before = value_;
  const double unknown = variance_ / greatest_variance_;
  const double kept = std::exp(-duration * (signal ? unknown * unknown / kForgetTime : 1.0 / kLostTime));
  value_ = within(kept * value_ - gain * innovation);
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
