#include "verify/parameter_sampler.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "region_maps/region_map.hpp"
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
    : map_(&map), engine_(spread(spread(seed) + stream)), solver_(static_cast<int>(map.parameters().size())) {
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

// Reads the half-spaces of the box and of a region, and finds the Chebyshev centre. Returns its radius.
double ParameterSampler::gatherRows(std::uint64_t index) {
  const Eigen::Index p = middle_.size();
  rows_.clear();
  const auto add = [&](const Eigen::VectorXd& a, double bound) {
    rows_.insert(rows_.end(), a.data(), a.data() + p);
    rows_.push_back(bound);
  };
  for (Eigen::Index j = 0; j < p; ++j) {
    add(Eigen::VectorXd::Unit(p, j), 1.0);
    add(-Eigen::VectorXd::Unit(p, j), 1.0);
  }
  const RegionView region = map_->region(index);
  for (std::uint32_t i = 0; i < region.row_count; ++i) {
    const double sign = region.rows[i] > 0 ? 1.0 : -1.0;
    const double* plane = map_->plane(static_cast<std::size_t>(std::abs(region.rows[i])) - 1);
    const Eigen::Map<const Eigen::VectorXd> a(plane, p);
    const double factor = sign / a.cwiseProduct(half_).norm();
    add(factor * a.cwiseProduct(half_), factor * (plane[p] - a.dot(middle_)));
  }
  centre_.setZero(p);
  double radius = 0.0;
  const int count = static_cast<int>(rows_.size()) / static_cast<int>(p + 1);
  if (solver_.chebyshevInBox(rows_.data(), count, centre_.data(), radius) &&
      radius > tolerance::kCertainRadius)
    return radius;
  // In fractions, where rounding might decide.
  const bool found = solver_.chebyshev(rows_.data(), count, centre_.data(), radius, true);
  return found ? radius : -std::numeric_limits<double>::infinity();
}

// Moves t along a direction to the nearest face. Returns its number, -1 if there is none.
Eigen::Index ParameterSampler::walk(Eigen::VectorXd& t, const Eigen::VectorXd& along) const {
  double nearest = std::numeric_limits<double>::infinity();
  Eigen::Index face = -1;
  for (Eigen::Index i = 0; i < rowCount(); ++i) {
    const double speed = normal(i).dot(along);
    if (speed <= tolerance::kParallelFace) continue;
    const double distance = std::max(0.0, bound(i) - normal(i).dot(t)) / speed;
    if (distance < nearest) {
      nearest = distance;
      face = i;
    }
  }
  if (face >= 0) t += nearest * along;
  return face;
}

ParameterSampler::Sample ParameterSampler::centre(std::uint64_t region) {
  const double radius = gatherRows(region);
  return toParameters(centre_, radius);
}

Eigen::VectorXd ParameterSampler::behindFacet() {
  const Eigen::VectorXd along = direction();
  Eigen::VectorXd t = centre_;
  const Eigen::Index face = walk(t, along);
  if (face >= 0) t += tolerance::kCheckedBehind / normal(face).dot(along) * along;
  return t.cwiseAbs().maxCoeff() > 1.0 ? Eigen::VectorXd() : toParameters(t, 1.0).theta;
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
    const Eigen::Index face = walk(t, along);
    if (face < 0) break;
    Eigen::VectorXd across = normal(face);
    across -= met * (met.transpose() * across);
    if (across.norm() < tolerance::kShortDirection) break;
    met.conservativeResize(p, met.cols() + 1);
    met.col(met.cols() - 1) = across.normalized();
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
