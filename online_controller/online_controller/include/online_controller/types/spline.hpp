#pragma once

#include <Eigen/Core>
#include <vector>

namespace polyfly {

/// A point of a curve over time with position [m] and yaw [rad] as its four entries.
struct Knot {
  double time = 0.0;                                    ///< [s]
  Eigen::Vector4d value = Eigen::Vector4d::Zero();      ///< [m, m, m, rad]
  Eigen::Vector4d slope = Eigen::Vector4d::Zero();      ///< [m/s, rad/s]
  Eigen::Vector4d curvature = Eigen::Vector4d::Zero();  ///< second derivative [m/s^2, rad/s^2]
};

/// Slopes and curvatures at the knots of the cubic spline through them: the curve whose second derivative is
/// continuous. At an end the given slope holds where `first_given` or `last_given` says so. Else the piece there is a
/// parabola, so that parabolas come out exactly. At least two knots, times increasing. Source: the usual tridiagonal
/// equations for the slopes, which are regular for all such knots.
void fitSpline(std::vector<Knot>& knots, bool first_given, bool last_given);

}  // namespace polyfly
