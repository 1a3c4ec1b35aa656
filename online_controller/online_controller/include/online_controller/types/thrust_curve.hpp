#pragma once

#include <vector>

namespace polyfly {

/// What an autopilot makes of thrust: a number from 0 to 1 in place of newtons.
struct ThrustCurveOptions {
  /// Coefficients c of c[0] + c[1] F + c[2] F^2 + ... with F in N; empty: proportional to F, with hover at
  /// hover_thrust.
  std::vector<double> polynomial;
  /// Value with which the autopilot hovers, without a polynomial.
  double hover_thrust = 0.5;
};

/// Thrust in newtons to an autopilot's thrust.
class ThrustCurve {
 public:
  /// `thrust_min`, `thrust_max` [N] are the limits of what the controller asks for, `hover` [N] the weight. Throws
  /// Error for a polynomial that does not increase over all that can be asked for, or leaves 0 to 1 at hover.
  ThrustCurve(const ThrustCurveOptions& options, double thrust_min, double thrust_max, double hover);

  /// From 0 to 1 for every `thrust` [N]: 0 without thrust and for NaN. A polynomial is
  /// believed only where it was tested: beyond thrust_max its value there holds, below thrust_min none above
  /// that there.
  double operator()(double thrust) const noexcept;

 private:
  double value(double thrust) const noexcept;

  std::vector<double> coefficients_;
  // Lower and upper end of the range in which the curve was tested [N].
  double begin_;
  double end_;
};

}  // namespace polyfly
