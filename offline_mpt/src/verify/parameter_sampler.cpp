#include "verify/parameter_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "lp/rational_polytope.hpp"
#include "region_maps/region_map.hpp"
#include "verify/interior_point_qp.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

// Spreads neighbouring seeds (Steele, Lea and Flood's finaliser, the constants as published).
std::uint64_t spread(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace

ParameterSampler::ParameterSampler(const RegionMap& map, std::uint64_t seed, std::uint64_t stream)
    : map_(&map), engine_(spread(spread(seed) + stream)) {
  const auto p = static_cast<Eigen::Index>(map.parameters().size());
  middle_.resize(p);
  half_.resize(p);
  for (Eigen::Index i = 0; i < p; ++i) {
    const Signal& signal = map.parameters()[static_cast<std::size_t>(i)];
    middle_[i] = 0.5 * (signal.lower + signal.upper);
    half_[i] = 0.5 * (signal.upper - signal.lower);
  }
}

double ParameterSampler::unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

std::uint64_t ParameterSampler::below(std::uint64_t count) { return engine_() % count; }

Eigen::VectorXd ParameterSampler::direction() {
  Eigen::VectorXd result(middle_.size());
  double norm = 0.0;
  do {
    for (Eigen::Index i = 0; i < result.size(); ++i) result[i] = 2.0 * unit() - 1.0;
    norm = result.norm();
  } while (norm < tolerance::kShortDirection);
  return result / norm;
}

ParameterSampler::Sample ParameterSampler::uniform() {
  Eigen::VectorXd t(middle_.size());
  for (Eigen::Index i = 0; i < t.size(); ++i) t[i] = 2.0 * unit() - 1.0;
  return toParameters(t, 1.0);
}

// Reads the half-spaces of a region and of the box, and finds the Chebyshev centre. Returns its radius.
double ParameterSampler::gatherRows(std::uint64_t index) {
  const RegionView region = map_->region(index);
  const Eigen::Index p = middle_.size();
  const auto count = static_cast<Eigen::Index>(region.row_count);
  rows_.setZero(count + 2 * p, p);
  bounds_.setOnes(count + 2 * p);
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::int32_t row = region.rows[i];
    const double sign = row > 0 ? 1.0 : -1.0;
    const double* plane = map_->plane(static_cast<std::size_t>(std::abs(row)) - 1);
    double bound = plane[p];
    for (Eigen::Index j = 0; j < p; ++j) {
      rows_(i, j) = sign * plane[j] * half_[j];
      bound -= plane[j] * middle_[j];
    }
    const double norm = rows_.row(i).norm();
    rows_.row(i) /= norm;
    bounds_[i] = sign * bound / norm;
  }
  for (Eigen::Index j = 0; j < p; ++j) {
    rows_(count + 2 * j, j) = 1.0;
    rows_(count + 2 * j + 1, j) = -1.0;
  }
  Eigen::MatrixXd A(rows_.rows(), p + 1);
  A << rows_, Eigen::VectorXd::Ones(rows_.rows());
  Eigen::VectorXd cost = Eigen::VectorXd::Zero(p + 1);
  cost[p] = -1.0;
  InteriorPointQp ball(Eigen::MatrixXd::Zero(p + 1, p + 1), A);
  const InteriorPointSolution& solution = ball.solve(cost, bounds_);
  if (solution.status != InteriorPointStatus::kOptimal) {
    centre_.setZero(p);
    return std::numeric_limits<double>::quiet_NaN();
  }
  centre_ = solution.z.head(p);
  const double radius = solution.z[p];
  return std::abs(radius) <= tolerance::kInteriorPointAccuracy ? exactRadius(A, radius) : radius;
}

// The greatest r with A (t, r) <= bounds_, about `radius`. So small a radius is less than the error of the program above.
double ParameterSampler::exactRadius(const Eigen::MatrixXd& A, double radius) const {
  const Eigen::Index width = A.cols() + 1;
  std::vector<double> rows;
  for (Eigen::Index i = 0; i < A.rows(); ++i) {
    for (Eigen::Index j = 0; j + 1 < width; ++j) rows.push_back(A(i, j));
    rows.push_back(bounds_[i]);
  }
  std::vector<double> start(centre_.data(), centre_.data() + centre_.size());
  start.push_back(radius - 2.0 * tolerance::kInteriorPointAccuracy);
  std::vector<double> direction(start.size(), 0.0), point(start.size());
  direction.back() = 1.0;
  const bool found = maximiseRationally(static_cast<int>(A.cols()), rows.data(), static_cast<int>(A.rows()),
                                        start.data(), direction.data(), point.data());
  return found ? point.back() : radius;
}

// Moves t along a direction to the nearest face, whose number is returned in `face`; -1 if there is none.
double ParameterSampler::walk(Eigen::VectorXd& t, const Eigen::VectorXd& along, Eigen::Index& face) const {
  double nearest = std::numeric_limits<double>::infinity();
  face = -1;
  for (Eigen::Index i = 0; i < rows_.rows(); ++i) {
    const double speed = rows_.row(i).dot(along);
    if (speed <= tolerance::kParallelFace) continue;
    const double distance = std::max(0.0, bounds_[i] - rows_.row(i).dot(t)) / speed;
    if (distance < nearest) {
      nearest = distance;
      face = i;
    }
  }
  if (face < 0) return 0.0;
  t += nearest * along;
  return nearest;
}

ParameterSampler::Sample ParameterSampler::degenerate() {
  const double radius = gatherRows(below(map_->regionCount()));
  Eigen::VectorXd t = centre_;
  const Eigen::Index p = t.size();
  // 0 faces: the centre; 1: a point on a face; p: a vertex.
  const auto faces = static_cast<Eigen::Index>(below(static_cast<std::uint64_t>(p) + 2));
  Eigen::VectorXd along = direction();
  Eigen::MatrixXd met(p, 0);  // orthonormal basis of the normals met
  for (Eigen::Index k = 0; k < std::min(faces, p); ++k) {
    Eigen::Index face = -1;
    walk(t, along, face);
    if (face < 0) break;
    Eigen::VectorXd normal = rows_.row(face).transpose();
    normal -= met * (met.transpose() * normal);
    if (normal.norm() < tolerance::kShortDirection) break;
    met.conservativeResize(p, met.cols() + 1);
    met.col(met.cols() - 1) = normal.normalized();
    along = direction();
    along -= met * (met.transpose() * along);
    if (along.norm() < tolerance::kShortDirection) break;
    along.normalize();
  }
  if (faces > 0) t += tolerance::kOffsets[below(std::size(tolerance::kOffsets))] * direction();
  return toParameters(t, radius);
}

ParameterSampler::Sample ParameterSampler::toParameters(const Eigen::VectorXd& t, double radius) const {
  Sample sample;
  sample.radius = radius;
  sample.theta.resize(t.size());
  for (Eigen::Index i = 0; i < t.size(); ++i) {
    const Signal& signal = map_->parameters()[static_cast<std::size_t>(i)];
    sample.theta[i] = std::clamp(middle_[i] + half_[i] * t[i], signal.lower, signal.upper);
  }
  return sample;
}

}  // namespace polyfly
