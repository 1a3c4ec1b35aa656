#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "polytope_sets/exact_polytope.hpp"
#include "polytope_sets/set_model.hpp"

namespace polyfly {

class RegionMap;

/// A region of a map within the box of the parameters, its half-spaces moved outwards by `moved`. [scaled]
ExactPolytope regionPolytope(const RegionMap& map, std::size_t region, const Rational& moved = 0);

/// theta+ = F theta + G u + E d + c over the parameters of a map, in the map's order; d in D.
struct ClosedLoopModel {
  RationalMatrix F;
  RationalMatrix G;
  RationalMatrix E;
  RationalVector c;
  ExactPolytope D;
};

/// Binds a model's signals to a map's by name. Throws Error when a parameter of the map is neither a state nor a
/// parameter of the model. Also when one of the model's is not in the map, and when inputs or units differ.
ClosedLoopModel bindModel(const SetModel& model, const RegionMap& map);

struct AnalyzeOptions {
  /// How far outside a half-space a parameter still counts as inside [scaled, see region_maps/FORMAT.md];
  /// below 0: the map's own membership tolerance, which its look-up grants.
  double tolerance = -1.0;
  /// Set of parameters to analyse instead of the whole domain.
  std::optional<ExactPolytope> within;
  /// Number of threads. The report does not depend on it.
  int threads = 1;  ///< 1..256
  /// Called from the calling thread, with the phase of the work.
  std::function<void(const char* phase, std::uint64_t done, std::uint64_t total)> progress;
};

/// A state that leaves: exact numbers, and what the map itself says of them.
struct AnalyzeWitness {
  /// The parameter, in exactly these doubles.
  std::vector<double> theta;
  /// Region whose successor set leaves the target.
  std::uint32_t region = 0;
  /// Answer of the map's look-up at theta.
  std::vector<double> u;
  /// A vertex of D.
  RationalVector d;
  /// F theta + G u + E d + c of exactly these numbers.
  RationalVector successor;
  /// The successor breaks a . successor <= b.
  ExactHalfSpace facet;
  /// Excess of the successor over the facet.
  double excess = 0.0;  ///< [scaled]
  /// Whether the look-up finds a region at theta.
  bool answered = false;
  /// Whether the look-up finds no region at the successor, or the successor is outside `within`.
  bool successor_outside = false;
  /// Whether the numbers above were evaluated again and break the facet by more than the tolerance.
  bool verified = false;
};

/// What was found of the closed loop. All of it is exact but for numbers that are named as rounded. The map's doubles
/// and the model's numbers count at their exact values. u = K theta + k is taken without rounding.
struct AnalyzeReport {
  /// The tolerance t.
  double tolerance = 0.0;  ///< [scaled]
  std::uint64_t regions = 0;

  /// The domain P: the box and those half-spaces of regions that hold all regions. No redundant row. With
  /// `within`: that set, its rows scaled to distances.
  bool is_within = false;
  std::vector<ExactHalfSpace> domain;
  /// No region reaches farther out of P than this [scaled, rounded up]; 0 for `within`.
  double region_excess = 0.0;

  /// Every theta of P lies in a region, each half-space moved outwards by t. Proven by cutting P into cells
  /// that each lie in one region. Together with region_excess: the union of the regions is the convex
  /// polytope P, up to t.
  bool covered = false;
  /// A point of P in no region, where P is not covered.
  std::optional<RationalVector> gap;

  /// For every region and d in D: let theta lie in the region, or in a sliver that is given to it. Then theta+ lies
  /// in P, with each half-space moved out by t. Not tested where the regions do not cover P, unless `within`.
  bool successors_inside = false;
  /// Greatest excess over regions and facets, rounded up. 0: no tolerance is needed.
  double greatest_excess = 0.0;  ///< [scaled]
  /// Regions with an excess above t.
  std::uint64_t offending_regions = 0;
  std::optional<AnalyzeWitness> witness;

  bool holds() const { return covered && successors_inside; }
};

/// Decides recursive feasibility of a map under a model, and invariance of its domain. A successor that lies
/// in the target lies in a region (covered), so the map answers there again: for ever, while d stays in D.
AnalyzeReport analyze(const RegionMap& map, const ClosedLoopModel& model, const AnalyzeOptions& options = {});

std::string analyzeText(const AnalyzeReport& report, const RegionMap& map, const SetModel& model);
std::string analyzeJson(const AnalyzeReport& report, const RegionMap& map, const SetModel& model);

}  // namespace polyfly
