#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "exact_kkt/exact_description.hpp"
#include "explore/region/region_builder.hpp"
#include "mpc_core/dense_qp.hpp"
#include "offline_mpt/explore_options.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// What describing one active set yields. It depends on that set alone.
struct RegionResult {
  BuildStatus status = BuildStatus::kEmptyInterior;
  Region region;
  ActiveSetList neighbours;
  /// Facet of each neighbour.
  std::vector<std::uint32_t> behind;
  /// Probes (p numbers each) that no candidate of their facet holds.
  std::vector<double> unresolved;
  std::uint32_t degenerate_facets = 0;
  /// Pivots of the linear programs.
  std::uint64_t pivots = 0;

  /// Clears everything but the region.
  void clear();
  void addNeighbour(const ActiveSet& active, std::uint32_t facet);
};

/// A facet whose candidates, neighbours `begin` to `end` - 1, are in doubt.
struct DegenerateFacet {
  std::uint32_t facet;
  std::size_t begin, end;
};

/// The work space of one thread for computeRegion.
struct RegionWorkspace {
  RegionWorkspace(const NormalisedProgram& program, const ExploreOptions& options)
      : builder(program, options.facet_tolerance, options.radius_tolerance),
        exact(program),
        qp(Eigen::MatrixXd::Identity(program.n, program.n), program.M) {}

  unsigned long long pivots() const { return builder.pivots(); }

  RegionBuilder builder;
  ExactDescription exact;
  DenseQp qp;
  ActiveSet candidate;
  std::vector<DegenerateFacet> degenerate;
};

/// Into `out`, whatever it held before.
void computeRegion(const NormalisedProgram& program, RegionWorkspace& workspace, const ActiveSet& active,
                   RegionResult& out);

/// Whether a probe that no region holds lies at the edge of the feasible set, or outside.
bool isEdge(const NormalisedProgram& program, const Eigen::VectorXd& probe);

/// A full-dimensional region to begin with, at or near t = `centre`; false where none is found.
bool findStart(const NormalisedProgram& program, const Eigen::VectorXd& centre, RegionWorkspace& worker,
               ActiveSet& active);

}  // namespace polyfly
