#include "online_controller/types/thrust_curve.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr int kProbes = 1000;  // places at which a polynomial is tested

void require(bool holds, const std::string& rule) {
  if (!holds) throw Error("output/thrust: " + rule);
}

}  // namespace

ThrustCurve::ThrustCurve(const ThrustCurveOptions& options, double thrust_min, double thrust_max,
                         double hover)
    : coefficients_(options.polynomial),
      begin_(options.polynomial.empty() ? 0.0 : thrust_min),
      end_(options.polynomial.empty() ? std::numeric_limits<double>::infinity() : thrust_max) {
  if (coefficients_.empty()) coefficients_ = {0.0, options.hover_thrust / hover};
  for (const double coefficient : coefficients_)
    require(std::isfinite(coefficient), "coefficients must be finite");
  for (int i = 0; i < kProbes; ++i) {
    const double from = thrust_min + (thrust_max - thrust_min) * i / kProbes;
    const double to = thrust_min + (thrust_max - thrust_min) * (i + 1) / kProbes;
    require(value(from) < value(to), "must increase from " + std::to_string(thrust_min) + " to " +
                                         std::to_string(thrust_max) + " N, does not at " +
                                         std::to_string(from) + " N");
  }
  require(value(hover) > 0.0 && value(hover) < 1.0,
          "hover must lie between 0 and 1, got " + std::to_string(value(hover)));
}

// By Horner's rule.
double ThrustCurve::value(double thrust) const noexcept {
  double sum = 0.0;
  for (auto c = coefficients_.rbegin(); c != coefficients_.rend(); ++c) sum = sum * thrust + *c;
  return sum;
}

double ThrustCurve::operator()(double thrust) const noexcept {
  if (!(thrust > 0.0)) return 0.0;  // NaN too
  double result = value(std::min(thrust, end_));
  if (thrust < begin_) result = std::min(result, value(begin_));
  // Written so that NaN gives 0.
  return result > 0.0 ? std::min(result, 1.0) : 0.0;
}

}  // namespace polyfly
