#pragma once

#include <string>
#include <vector>

#include "fixedwing_lateral/path.hpp"

namespace polyfly {

/// A twice continuously differentiable curve through points: a natural cubic spline over chord length. Smooth
/// enough to fly where the points turn gently; nothing limits its curvature.
class SplinePath : public PathCurve {
 public:
  /// Throws polyfly::Error, beginning with `where`, on fewer than two points, neighbours less than
  /// kShortestSegment apart, or a number that is not finite.
  SplinePath(const std::vector<Eigen::Vector2d>& points, const std::string& where);

  ClosestPoint closest(const Eigen::Vector2d& position) const noexcept override;
  double length() const noexcept override { return samples_.back().distance; }
  PathPoint pointAt(double distance) const noexcept override;

  const std::vector<Eigen::Vector2d>& points() const noexcept { return points_; }

 private:
  /// Position and derivatives by the parameter.
  struct Local {
    Eigen::Vector2d position, first, second;
  };
  struct Sample {
    double parameter;  // chord length
    double distance;   // along the curve, from the start
    Eigen::Vector2d position;
  };

  Local at(double parameter) const noexcept;
  void tabulate();
  double distanceAt(double parameter) const noexcept;

  std::vector<double> knots_;  // parameters of the points
  std::vector<Eigen::Vector2d> points_;
  std::vector<Eigen::Vector2d> curvatures_;  // second derivatives at the points
  std::vector<Sample> samples_;
};

}  // namespace polyfly
