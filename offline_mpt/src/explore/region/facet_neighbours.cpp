#include "explore/region/facet_neighbours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "explore/region/starting_point.hpp"
#include "explore/region/tolerances.hpp"
#include "mpc_core/decompositions.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostPieces = 20'000;

}  // namespace

FacetNeighbours::FacetNeighbours(const NormalisedProgram& program, double facet_tolerance,
                                 double radius_tolerance)
    : program_(program), builder_(program, facet_tolerance, radius_tolerance) {
  if (program.p > 1) solver_.emplace(program.p - 1);
  const double mean = program.curvature.trace() / program.n;
  for (const double added : tolerance::kAddedIdentity)
    qps_.emplace_back(program.curvature + added * mean * Eigen::MatrixXd::Identity(program.n, program.n),
                      program.A);
}

// Coordinates s of the facet's plane: t = foot + basis s.
void FacetNeighbours::lay(const Facet& facet) {
  const int p = program_.p;
  normal_ = Eigen::Map<const Eigen::VectorXd>(facet.row.data(), p);
  offset_ = facet.row[p];
  foot_ = offset_ * normal_;
  basis_ = orthogonalFactors(normal_).Q.rightCols(p - 1);
  behind_.clear();
  behind_sets_.clear();
}

// Adds sign * (a . t <= b) to the piece. False where nothing of the plane is left.
bool FacetNeighbours::restrict(const Facet& facet, int sign, ConvexCell& piece) const {
  const Eigen::Map<const Eigen::VectorXd> a(facet.row.data(), program_.p);
  const Eigen::VectorXd along = sign * (basis_.transpose() * a);
  const double bound = sign * (facet.row[program_.p] - a.dot(foot_));
  const double length = along.norm();
  if (length <= tolerance::kParallelPlanes) return bound >= -tolerance::kThinPiece;
  for (const double value : along) piece.push_back(value / length);
  piece.push_back(bound / length);
  return true;
}

double FacetNeighbours::radius(const ConvexCell& piece, Eigen::VectorXd& centre) {
  centre = Eigen::VectorXd::Zero(program_.p - 1);
  if (!solver_) return 1.0;
  double value = 0.0;
  const int count = static_cast<int>(piece.size()) / program_.p;
  return solver_->chebyshev(piece.data(), count, centre.data(), value) ? value : 0.0;
}

// Whether the set describes a region behind the facet, which then joins the others.
bool FacetNeighbours::takeRegion(const ActiveSet& active) {
  if (std::find(behind_sets_.begin(), behind_sets_.end(), active) != behind_sets_.end()) return false;
  Region region;
  if (builder_.build(active, region) != BuildStatus::kRegion) return false;
  const Eigen::Map<const Eigen::VectorXd> centre(region.centre.data(), program_.p);
  if (normal_.dot(centre) <= offset_) return false;
  behind_.push_back(std::move(region));
  behind_sets_.push_back(active);
  return true;
}

FacetNeighbours::Behind FacetNeighbours::lookBehind(const Eigen::VectorXd& t) {
  ActiveSet active;
  if (!activeSetAt(program_, qps_[0], t + tolerance::kBehindFacet[3] * normal_, tolerance::kProbeEdge, 0.0,
                   active))
    return Behind::kBoundary;
  const double mean = program_.curvature.trace() / program_.n;
  const auto holds = [&](const Region& region) {
    return std::all_of(region.facets.begin(), region.facets.end(), [&](const Facet& facet) {
      const Eigen::Map<const Eigen::VectorXd> a(facet.row.data(), program_.p);
      return a.dot(t) <= facet.row[program_.p] + tolerance::kHeldOnFacet;
    });
  };
  for (const double step : tolerance::kBehindFacet) {
    const Eigen::VectorXd probe = t + step * normal_;
    for (std::size_t k = 0; k < qps_.size(); ++k) {
      if (!activeSetAt(program_, qps_[k], probe, 0.0,
                       tolerance::kActiveShare * tolerance::kAddedIdentity[k] * mean, active))
        continue;
      if (takeRegion(active) && holds(behind_.back())) return Behind::kRegion;
    }
  }
  const Eigen::VectorXd probe = t + tolerance::kBehindFacet[3] * normal_;
  double lengths[2] = {0.0, 0.0};
  for (const std::size_t k : {0u, 1u}) {
    if (activeSetAt(program_, qps_[k], probe, 0.0, 0.0, active)) lengths[k] = qps_[k].z().norm();
  }
  const double distance = program_.D.size() > 0 ? program_.D.cwiseAbs().maxCoeff() : 1.0;
  const bool without_limit = lengths[1] > tolerance::kUnlimitedGrowth * lengths[0] &&
                             lengths[1] > tolerance::kUnlimitedSize * (1.0 + distance);
  return without_limit ? Behind::kBoundary : Behind::kUnknown;
}

// How far the way behind the facet leads from t until it leaves the parameters' set.
double FacetNeighbours::distanceToBoundary(const Eigen::VectorXd& t) const {
  const auto p = static_cast<std::size_t>(program_.p);
  double most = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < program_.domain.size(); i += p + 1) {
    const Eigen::Map<const Eigen::VectorXd> a(program_.domain.data() + i, program_.p);
    const double slope = a.dot(normal_);
    if (slope > 0.0) most = std::min(most, std::max(program_.domain[i + p] - a.dot(t), 0.0) / slope);
  }
  return most;
}

// Cuts the piece by the region's rows: what lies outside of them joins `rest`. False, with `rest` as it was,
// where the region holds nothing of the piece.
bool FacetNeighbours::cut(const ConvexCell& piece, const Region& region, std::vector<ConvexCell>& rest) {
  const std::size_t before = rest.size();
  ConvexCell inside = piece;
  Eigen::VectorXd centre;
  bool left = true;
  for (const Facet& facet : region.facets) {
    ConvexCell outside = inside;
    if (restrict(facet, -1, outside) && outside.size() > inside.size() &&
        radius(outside, centre) > tolerance::kThinPiece)
      rest.push_back(std::move(outside));
    left = restrict(facet, 1, inside) && radius(inside, centre) > tolerance::kThinPiece;
    if (!left) break;
  }
  if (!left) rest.resize(before);
  return left;
}

void FacetNeighbours::find(const Facet& facet, const Region& region, const ActiveSetList& candidates,
                           ActiveSetList& found, std::vector<double>& unresolved) {
  lay(facet);
  std::vector<ConvexCell> pieces(1);
  for (const Facet& other : region.facets) {
    if (&other != &facet && !restrict(other, 1, pieces[0])) return;
  }
  for (std::size_t k = 0; k < candidates.size(); ++k)
    takeRegion(ActiveSet(candidates[k].begin(), candidates[k].end()));
  Eigen::VectorXd centre;
  for (std::size_t round = 0; !pieces.empty() && round < kMostPieces; ++round) {
    const ConvexCell piece = std::move(pieces.back());
    pieces.pop_back();
    if (radius(piece, centre) <= tolerance::kThinPiece) continue;
    if (std::any_of(behind_.begin(), behind_.end(),
                    [&](const Region& other) { return cut(piece, other, pieces); }))
      continue;
    const Eigen::VectorXd t = foot_ + basis_ * centre;
    const std::size_t known = behind_.size();
    const Behind what = lookBehind(t);
    // The feasible set is convex, so the boundary reaches along the whole facet.
    if (what == Behind::kBoundary) break;
    if (what == Behind::kRegion || behind_.size() > known) {
      pieces.push_back(piece);
      continue;
    }
    const Eigen::VectorXd probe =
        t + std::min(tolerance::kBehindFacet[1], 0.5 * distanceToBoundary(t)) * normal_;
    unresolved.insert(unresolved.end(), probe.data(), probe.data() + program_.p);
  }
  for (const ActiveSet& active : behind_sets_) found.push({active.data(), active.size()});
}

}  // namespace polyfly
