#include "fixedwing_lateral/spline_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr int kSamplesPerPiece = 16;
constexpr int kNewtonSteps = 8;
constexpr double kNewtonEnd = 1e-12;  // relative to the whole parameter

/// Gauss-Legendre nodes and weights on [0, 1].
constexpr double kNodes[3] = {0.1127016653792583, 0.5, 0.8872983346207417};
constexpr double kWeights[3] = {5.0 / 18.0, 8.0 / 18.0, 5.0 / 18.0};

}  // namespace

SplinePath::SplinePath(const std::vector<Eigen::Vector2d>& points, const std::string& where)
    : points_(points) {
  if (points.size() < 2) throw Error(where + ": a spline needs at least two points");
  knots_.push_back(0.0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) throw Error(where + ": point " + std::to_string(i) + ": must be finite");
    if (i == 0) continue;
    const double chord = (points[i] - points[i - 1]).norm();
    if (chord < kShortestSegment)
      throw Error(where + ": point " + std::to_string(i) + ": must differ from the one before");
    knots_.push_back(knots_.back() + chord);
  }
  // Second derivatives of the natural spline: a tridiagonal system, by elimination.
  const std::size_t last = points.size() - 1;
  curvatures_.assign(points.size(), Eigen::Vector2d::Zero());
  std::vector<double> diagonal(points.size(), 1.0);
  for (std::size_t i = 1; i < last; ++i) {
    const double before = knots_[i] - knots_[i - 1];
    const double after = knots_[i + 1] - knots_[i];
    diagonal[i] = 2.0 * (before + after);
    curvatures_[i] = 6.0 * ((points[i + 1] - points[i]) / after - (points[i] - points[i - 1]) / before);
    if (i == 1) continue;
    const double factor = before / diagonal[i - 1];
    diagonal[i] -= factor * before;
    curvatures_[i] -= factor * curvatures_[i - 1];
  }
  for (std::size_t i = last; i-- > 1;) {
    const double after = knots_[i + 1] - knots_[i];
    curvatures_[i] = ((curvatures_[i] - after * curvatures_[i + 1]) / diagonal[i]).eval();
  }
  tabulate();
}

SplinePath::Local SplinePath::at(double parameter) const noexcept {
  const auto above = std::upper_bound(knots_.begin() + 1, knots_.end() - 1, parameter);
  const auto i = static_cast<std::size_t>(above - knots_.begin()) - 1;
  const double width = knots_[i + 1] - knots_[i];
  const double b = (parameter - knots_[i]) / width;
  const double a = 1.0 - b;
  const Eigen::Vector2d& m = curvatures_[i];
  const Eigen::Vector2d& n = curvatures_[i + 1];
  Local local;
  local.position =
      a * points_[i] + b * points_[i + 1] + width * width / 6.0 * ((a * a * a - a) * m + (b * b * b - b) * n);
  local.first = (points_[i + 1] - points_[i]) / width +
                width / 6.0 * ((3.0 * b * b - 1.0) * n - (3.0 * a * a - 1.0) * m);
  local.second = a * m + b * n;
  return local;
}

void SplinePath::tabulate() {
  samples_.push_back({0.0, 0.0, points_.front()});
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    for (int j = 1; j <= kSamplesPerPiece; ++j) {
      const double parameter = knots_[i] + (knots_[i + 1] - knots_[i]) * j / kSamplesPerPiece;
      const double before = samples_.back().parameter;
      double distance = samples_.back().distance;
      for (int g = 0; g < 3; ++g)
        distance +=
            kWeights[g] * (parameter - before) * at(before + kNodes[g] * (parameter - before)).first.norm();
      samples_.push_back({parameter, distance, at(parameter).position});
    }
  }
}

double SplinePath::distanceAt(double parameter) const noexcept {
  const auto above =
      std::upper_bound(samples_.begin() + 1, samples_.end() - 1, parameter,
                       [](double value, const Sample& sample) { return value < sample.parameter; });
  const Sample& before = *(above - 1);
  double distance = before.distance;
  for (int g = 0; g < 3; ++g) {
    const double width = parameter - before.parameter;
    distance += kWeights[g] * width * at(before.parameter + kNodes[g] * width).first.norm();
  }
  return distance;
}

// From the nearest sample by Newton's method on the derivative of the squared distance.
ClosestPoint SplinePath::closest(const Eigen::Vector2d& position) const noexcept {
  std::size_t nearest = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    const double squared = (samples_[i].position - position).squaredNorm();
    if (squared < least) {
      least = squared;
      nearest = i;
    }
  }
  const double lower = samples_[nearest == 0 ? 0 : nearest - 1].parameter;
  const double upper = samples_[std::min(nearest + 1, samples_.size() - 1)].parameter;
  double parameter = samples_[nearest].parameter;
  Local local = at(parameter);
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Eigen::Vector2d from = local.position - position;
    const double slope = from.dot(local.first);
    // Without the curve's own bend where that would lead away from the minimum.
    const double bend = local.first.squaredNorm() + from.dot(local.second);
    const double next =
        std::clamp(parameter - slope / (bend > 0.0 ? bend : local.first.squaredNorm()), lower, upper);
    const bool settled = std::abs(next - parameter) <= kNewtonEnd * knots_.back();
    parameter = next;
    local = at(parameter);
    if (settled) break;
  }
  const double speed = local.first.norm();
  ClosestPoint result;
  result.point = {local.position, local.first / speed};
  result.remaining = length() - distanceAt(parameter);
  const double along = result.point.tangent.dot(position - local.position);
  if (parameter <= 0.0 && along < 0.0) result.foot = Foot::kBeforeStart;
  if (parameter >= knots_.back() && along > 0.0) result.foot = Foot::kPastEnd;
  if (result.foot == Foot::kOnSegment)
    result.curvature =
        (local.first.x() * local.second.y() - local.first.y() * local.second.x()) / (speed * speed * speed);
  return result;
}

PathPoint SplinePath::pointAt(double distance) const noexcept {
  const auto above =
      std::upper_bound(samples_.begin() + 1, samples_.end() - 1, distance,
                       [](double value, const Sample& sample) { return value < sample.distance; });
  const Sample& before = *(above - 1);
  const double share = (distance - before.distance) / (above->distance - before.distance);
  double parameter = before.parameter + share * (above->parameter - before.parameter);
  for (int step = 0; step < kNewtonSteps; ++step) {
    const double missing = distance - distanceAt(parameter);
    if (std::abs(missing) <= kNewtonEnd * length()) break;
    parameter = std::clamp(parameter + missing / at(parameter).first.norm(), 0.0, knots_.back());
  }
  const Local local = at(parameter);
  return {local.position, local.first.normalized()};
}

}  // namespace polyfly
