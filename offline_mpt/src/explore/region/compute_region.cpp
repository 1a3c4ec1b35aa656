#include "explore/region/compute_region.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include "explore/region/starting_point.hpp"
#include "explore/region/tolerances.hpp"
#include "program/feasible_slack.hpp"

namespace polyfly {
namespace {

/// A point just across the facet, on the way from the region's centre to a point beyond.
Eigen::VectorXd across(const Region& region, const Facet& facet, int p, double step) {
  double distance = 0.0;
  for (int j = 0; j < p; ++j) distance = std::max(distance, std::abs(facet.beyond[j] - region.centre[j]));
  double fraction = crossingFraction(region, facet);
  fraction = std::min(0.5 * (fraction + 1.0), fraction + step / std::max(distance, step));
  Eigen::VectorXd probe(p);
  for (int j = 0; j < p; ++j) probe(j) = region.centre[j] + fraction * (facet.beyond[j] - region.centre[j]);
  return probe;
}

/// A degenerate facet and its candidates, neighbours `begin` to `end` - 1, of which one must hold a point
/// just across it. Where none does so clearly, a program of its own finds the active set there, which joins
/// them. Where H is zero and that one does not hold the point either, fractions find it.
void probeFacet(const NormalisedProgram& program, RegionWorkspace& worker, const DegenerateFacet& degenerate,
                RegionResult& out) {
  const double widen = program.linear && !program.constantCost() ? tolerance::kLinearProbe : 1.0;
  const Facet& facet = out.region.facets[degenerate.facet];
  const Eigen::VectorXd probe = across(out.region, facet, program.p, widen * tolerance::kProbeStep);
  const auto held = [&](double tolerance) {
    for (std::size_t k = degenerate.begin; k < degenerate.end; ++k) {
      worker.candidate.assign(out.neighbours[k].begin(), out.neighbours[k].end());
      if (worker.builder.holds(worker.candidate, probe.data(), tolerance)) return true;
    }
    return false;
  };
  if (held(-tolerance::kClearlyInside)) return;
  ActiveSet active;
  // A probe without an active set lies at the edge of the feasible set.
  if (!activeSetAt(program, worker.qp, probe, widen * tolerance::kProbeEdge, active)) return;
  if (!activeSetAt(program, worker.qp, probe, 0.0, active)) return;
  const auto isFound = [&] {
    out.addNeighbour(active, degenerate.facet);
    return worker.builder.holds(active, probe.data(), tolerance::kHeldProbe);
  };
  if (isFound() || held(tolerance::kHeldProbe)) return;
  if (program.linear && worker.exact.activeSetAt(probe, active) && isFound()) return;
  Region optimal;
  if (worker.builder.build(active, optimal) == BuildStatus::kRegion) return;  // ill-conditioned, but not lost
  out.unresolved.insert(out.unresolved.end(), probe.data(), probe.data() + program.p);
}

/// The same set without one of its rows, for each: one of its multipliers is zero everywhere.
void addSmallerSets(const ActiveSet& active, ActiveSetList& sets) {
  for (const std::uint16_t row : active) sets.push({active.data(), active.size()}, row);
}

/// What lies about a flat set.
void addAround(RegionWorkspace& worker, const ActiveSet& active, RegionResult& out) {
  for (const Facet& facet : out.region.facets)
    worker.builder.neighbours(active, out.region, facet, out.neighbours);
}

/// The regions behind each facet. Degenerate facets come after all others: a probe overwrites the builder's
/// rows.
void crossFacets(const NormalisedProgram& program, RegionWorkspace& worker, const ActiveSet& active,
                 RegionResult& out) {
  worker.degenerate.clear();
  for (std::uint32_t f = 0; f < out.region.facets.size(); ++f) {
    const std::size_t begin = out.neighbours.size();
    const Crossing crossing =
        worker.builder.neighbours(active, out.region, out.region.facets[f], out.neighbours);
    out.behind.resize(out.neighbours.size(), f);
    if (crossing == Crossing::kDegenerate) worker.degenerate.push_back({f, begin, out.neighbours.size()});
    if (crossing == Crossing::kDegenerate || crossing == Crossing::kExchange) ++out.degenerate_facets;
  }
  for (const DegenerateFacet& degenerate : worker.degenerate) probeFacet(program, worker, degenerate, out);
}

}  // namespace

// The edge of the feasible set after all.
bool isEdge(const NormalisedProgram& program, const Eigen::VectorXd& probe) {
  const std::optional<double> slack = feasibleSlack(program, probe);
  return slack && *slack <= tolerance::kProbeEdge;
}

void RegionResult::clear() {
  neighbours.clear();
  behind.clear();
  unresolved.clear();
  degenerate_facets = 0;
}

void RegionResult::addNeighbour(const ActiveSet& active, std::uint32_t facet) {
  neighbours.push({active.data(), active.size()});
  behind.push_back(facet);
}

void computeRegion(const NormalisedProgram& program, RegionWorkspace& worker, const ActiveSet& active,
                   RegionResult& out) {
  const unsigned long long before = worker.pivots();
  out.clear();
  out.status = worker.builder.build(active, out.region);
  switch (out.status) {
    case BuildStatus::kRegion:
      crossFacets(program, worker, active, out);
      break;
    case BuildStatus::kLowerDimensional:
      addAround(worker, active, out);
      break;
    case BuildStatus::kWeaklyActive:
      addSmallerSets(active, out.neighbours);
      break;
    case BuildStatus::kEmptyInterior:
    case BuildStatus::kDependent:
    case BuildStatus::kFailed:
      break;
  }
  out.pivots = worker.pivots() - before;
}

bool findStart(const NormalisedProgram& program, const Eigen::VectorXd& centre, RegionWorkspace& worker,
               ActiveSet& active) {
  std::mt19937_64 random(1);
  constexpr int kTries = 200;
  Region region;
  for (int round = 0; round < kTries; ++round) {
    Eigen::VectorXd t = centre;
    const double spread = round == 0 ? 0.0 : std::pow(10.0, -1.0 - round % 6);
    for (int j = 0; j < program.p; ++j) {
      const double unit = static_cast<double>(random() >> 11) * 0x1.0p-53;
      t(j) += spread * (2.0 * unit - 1.0);
    }
    if (!activeSetAt(program, worker.qp, t, 0.0, active)) continue;
    if (worker.builder.build(active, region) == BuildStatus::kRegion) return true;
    if (program.linear && worker.exact.activeSetAt(t, active) &&
        worker.builder.build(active, region) == BuildStatus::kRegion)
      return true;
  }
  return false;
}

}  // namespace polyfly
