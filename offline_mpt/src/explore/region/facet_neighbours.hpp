#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "explore/region/region_builder.hpp"
#include "lp/polytope.hpp"
#include "mpc_core/dense_qp.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Finds all regions behind a facet of a program whose H is singular: there, what lies behind may change
/// along the facet, and the changes of the active set do not tell it. The facet is cut by the regions that
/// are known to lie behind it; in what is left, programs of their own find the next one, until nothing is
/// left. What it finds depends on the facet alone. One object, one thread.
class FacetNeighbours {
 public:
  FacetNeighbours(const NormalisedProgram& program, double facet_tolerance, double radius_tolerance);

  /// Adds the active sets of the regions behind `facet` to `found`; `candidates` are asked first. Points
  /// behind which no region was found join `unresolved` (p numbers each).
  void find(const Facet& facet, const Region& region, const ActiveSetList& candidates, ActiveSetList& found,
            std::vector<double>& unresolved);

  unsigned long long pivots() const { return builder_.pivots() + (solver_ ? solver_->pivots() : 0); }

 private:
  using ConvexCell = std::vector<double>;  // rows in coordinates of the facet's plane
  enum class Behind { kRegion, kBoundary, kUnknown };

  void lay(const Facet& facet);
  bool restrict(const Facet& facet, int sign, ConvexCell& piece) const;
  double radius(const ConvexCell& piece, Eigen::VectorXd& centre);
  bool takeRegion(const ActiveSet& active);
  Behind lookBehind(const Eigen::VectorXd& t);
  double distanceToBoundary(const Eigen::VectorXd& t) const;
  bool cut(const ConvexCell& piece, const Region& region, std::vector<ConvexCell>& rest);

  const NormalisedProgram& program_;
  RegionBuilder builder_;
  std::optional<PolytopeSolver> solver_;  // none where a facet is a point
  std::vector<DenseQp> qps_;              // each with something else added to H
  Eigen::VectorXd normal_, foot_;
  Eigen::MatrixXd basis_;  // p x (p - 1)
  double offset_ = 0.0;
  std::vector<Region> behind_;
  std::vector<ActiveSet> behind_sets_;
};

}  // namespace polyfly
