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
                                         double deviation, double first_noise)
    : derivative_(drivenByDisturbance(problem), options),
      state_(state),
      period_(options.period),
      greatest_variance_(deviation * deviation),
      variance_(greatest_variance_),
      first_noise_(first_noise * derivative_.innovationVariance(state)),
      record_(freshRecord()) {}

CoefficientEstimate::Record CoefficientEstimate::freshRecord() const noexcept {
  Record fresh;
  fresh.innovation_square = first_noise_;
  return fresh;
}

// White noise of variance v leaves v share / 2 behind the low pass.
void CoefficientEstimate::record(double innovation, double slope, double duration) noexcept {
  constexpr double kLowPassTime = 0.5, kRecordTime = 7.0;  // [s]
  const double share = std::min(1.0, duration / kLowPassTime);
  record_.innovation += share * (innovation - record_.innovation);
  record_.slope += share * (slope - record_.slope);
  const double newest = std::min(1.0, duration / kRecordTime);
  const auto average = [&](double& mean, double a, double b) {
    mean += newest * (2.0 / share * a * b - mean);
  };
  average(record_.innovation_square, record_.innovation, record_.innovation);
  average(record_.product, record_.innovation, record_.slope);
  average(record_.slope_square, record_.slope, record_.slope);
}

// What the c of least squares leaves of the innovations. A short record of little noise is no proof that there is none.
double CoefficientEstimate::noise() const noexcept {
  constexpr double kLeastShare = 0.1;
  const double explained =
      record_.slope_square > 0.0 ? record_.product * record_.product / record_.slope_square : 0.0;
  return std::max(record_.innovation_square - explained,
                  kLeastShare * derivative_.innovationVariance(state_));
}

void CoefficientEstimate::update(DisturbanceObserver& observer, std::optional<double> signal,
                                 int periods) noexcept {
  constexpr std::array<double, DisturbanceObserver::kMaxStates> kNothing{};
  const double driven = signal.value_or(0.0);
  derivative_.update(kNothing.data(), &driven, periods);
  const double duration = period_ * periods;
  const double innovation = observer.innovation(state_);
  // What a change of c adds to the innovation.
  const double slope = derivative_.innovation(state_);
  record(innovation - slope * value_, slope, duration);
  variance_ = std::min(variance_ + greatest_variance_ * duration / kForgetTime, greatest_variance_);
  const double before = value_;
  if (signal) {
    const double gain = variance_ * slope / (slope * slope * variance_ + noise());
    variance_ -= gain * slope * variance_;
    const double unknown = variance_ / greatest_variance_;
    value_ = within(std::exp(-duration * unknown * unknown / kForgetTime) * value_ - gain * innovation);
  } else {
    value_ *= std::exp(-duration / kLostTime);
  }
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
  record_ = freshRecord();
}

void CoefficientEstimate::transferState(const CoefficientEstimate& other, double more) noexcept {
  derivative_.transferState(other.derivative_);
  variance_ = more == 0.0 ? std::min(other.variance_, greatest_variance_) : greatest_variance_;
  record_ = more == 0.0 ? other.record_ : freshRecord();
  value_ = within(other.value_ + more);
}

}  // namespace polyfly
