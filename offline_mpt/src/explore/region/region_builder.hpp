#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include "explore/region/high_precision_region.hpp"
#include "explore/region/kkt_solver.hpp"
#include "explore/region/row_factor.hpp"
#include "explore/region/tolerances.hpp"
#include "explore/sets/active_set_list.hpp"
#include "lp/float_lp.hpp"
#include "lp/polytope.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Where a half-space of a region comes from.
struct RowOrigin {
  enum class Kind : std::uint8_t { kMultiplier, kCostMultiplier, kSlack, kDomain };
  Kind kind = Kind::kDomain;
  int index = 0;  ///< row of the program (multiplier, cost multiplier, slack) or of the domain
};

/// A half-space that bounds a region, and what lies behind it.
struct Facet {
  RowOrigin origin;
  std::array<double, PolytopeSolver::kMaxDimension + 1> row;  ///< (a, b) in p + 1 scaled parameters
  std::array<double, PolytopeSolver::kMaxDimension> beyond;   ///< a point that violates this row alone, p
};

/// A full-dimensional region in scaled parameters.
struct Region {
  std::vector<Facet> facets;
  std::vector<double> centre;
  double radius = 0.0;
  ActiveSet tight;          ///< rows that hold with equality everywhere, the active ones among them
  bool by_slack = false;    ///< only slacks bound the region: it depends on `tight` alone
  std::vector<double> law;  ///< q rows of p + 1 numbers: u = law (t, 1)

  /// Whether `tight` names the region: other active sets than this one, of so many rows, may describe it, too.
  bool isKnownByTightRows(std::size_t active_count) const { return by_slack && tight.size() > active_count; }
};

/// Where the way from the region's centre, 0, to the point beyond the facet, 1, crosses it.
double crossingFraction(const Region& region, const Facet& facet);

enum class BuildStatus : std::uint8_t {
  /// The region is full-dimensional.
  kRegion,
  /// The region is empty or flatter than the tolerance.
  kEmptyInterior,
  /// The region is thin, but may be the only way to the regions behind it.
  kLowerDimensional,
  /// The active rows are linearly dependent.
  kDependent,
  /// A multiplier is zero everywhere, so the set without its row describes the same solution.
  kWeaklyActive,
  /// The simplex gave up.
  kFailed,
};

/// What lies behind a facet.
enum class Crossing : std::uint8_t {
  kBoundary,    ///< nothing: the box, or the end of the feasible set
  kSingle,      ///< one active set, along the whole facet
  kExchange,    ///< several candidates, the first of which begins where the way to the point beyond crosses
  kDegenerate,  ///< several candidates: which is optimal depends on the place, or rows coincide
};

/// Turns active sets into regions. Everything it computes for a set depends on that set alone: where its rows
/// depend on each other so nearly that doubles would mislead, it is described accurately and then rounded.
/// One object, one thread.
class RegionBuilder {
 public:
  RegionBuilder(const NormalisedProgram& program, double facet_tolerance, double radius_tolerance);
  RegionBuilder(const RegionBuilder&) = delete;
  RegionBuilder& operator=(const RegionBuilder&) = delete;

  /// kRegion: the whole of `region` is filled in; kLowerDimensional: all but the law, with the half-spaces moved
  /// outwards.
  BuildStatus build(const ActiveSet& active, Region& region);

  /// Adds the active sets that can be optimal across `facet` of the region of `active`, which must be the
  /// last one built. Of several, that which is likeliest where the way to the point beyond crosses the facet
  /// is the first.
  Crossing neighbours(const ActiveSet& active, const Region& region, const Facet& facet, ActiveSetList& sets);

  /// Whether t satisfies all rows of the region of `active` but for `tolerance` (negative: with so much to
  /// spare); false where the active rows are dependent.
  bool holds(const ActiveSet& active, const double* t, double tolerance);

  unsigned long long pivots() const { return solver_.pivots(); }

  /// Whether each row of the program nearly repeats another one; empty where none does.
  const std::vector<char>& nearRows() const { return near_rows_; }

 private:
  BuildStatus solve(const ActiveSet& active);
  BuildStatus solveAccurately(const ActiveSet& active);
  BuildStatus measure(const ActiveSet& active, Region& region);
  /// Even estimates of errors do.
  bool isIllConditioned() const { return doubtful_ || factor_.pivot() < tolerance::kDistant; }
  /// Then the region that doubles describe holds the right one, and perhaps more.
  bool isCostOpen() const { return rounded_->isCostOpen() && !is_cost_rounded_; }
  bool isFlat(const Region& region) const;
  BuildStatus findFacets(const ActiveSet& active, double tolerance, Region& region);
  BuildStatus decideNearRows(double tolerance);
  bool isNeeded(std::vector<std::pair<int, std::vector<double>>>& left, std::size_t place, double tolerance,
                bool& failed);
  BuildStatus inflateFlat(const ActiveSet& active, Region& region);
  static double steepness(const std::vector<double>& law, const std::vector<double>& centre);
  bool needsAccuracy(BuildStatus status, const Region& region) const;
  bool holdsAsSolved(const ActiveSet& active, const double* t, double tolerance);
  void clearRows();
  bool satisfied(const double* t, double tolerance) const;
  bool holdsSlacks(const ActiveSet& active, const double* t, double tolerance);
  void startRows(const ActiveSet& active);
  BuildStatus assembleRows(const ActiveSet& active);
  bool addRow(const double* affine, RowOrigin origin, double scale, double noise, BuildStatus& status);
  BuildStatus addMultiplierRows(const ActiveSet& active);
  BuildStatus addSlackRows(const ActiveSet& active);
  void findChanges(const Facet& facet);
  void cross(const ActiveSet& active, const Region& region, const Facet& facet);
  /// Rows of sets that need accuracy are compared themselves.
  bool depends(const ActiveSet& active, int row) {
    return factor_.depends(active, row, kkt_ == rounded_.get());
  }
  int exchange(const ActiveSet& active, int row, ActiveSetList& sets) const;
  bool beginsBehind(const ActiveSet& active, int leaving);
  bool slacksStay(int facet, double change) const;
  void combine(const ActiveSet& active, ActiveSetList& sets);
  double valueOf(const double* affine, const double* t) const;

  const NormalisedProgram& program_;
  double facet_tolerance_;
  // Whether each row of the program nearly repeats another; empty where none does.
  std::vector<char> near_rows_;
  double radius_tolerance_;
  int width_;  // p + 1
  RowTables tables_;
  RowFactor factor_;
  // Solves in doubles. factor_ is brought to the set before.
  std::unique_ptr<ProgramKktSolver> rounded_;
  HighPrecisionRegionSolver accurate_;
  // Which of the two solved the set.
  const KktSolver* kkt_;
  std::vector<double> multipliers_;  // k x (p + 1)
  // Where H is zero, in the layout of multipliers_.
  std::vector<double> cost_multipliers_;
  // Greatest entry of multipliers_.
  double size_ = 0.0;
  // Greatest |entry| of the bounds of active rows, at least 1.
  double scale_ = 1.0;
  // Fractions could not tell either: what doubles take for zero of the cost is zero.
  bool is_cost_rounded_ = false;
  // Whether rounding decided that a row is constant.
  bool doubtful_ = false;
  // Approximate rounding error of the half-spaces in the box.
  double plane_error_ = 0.0;  // [scaled]
  // Approximate rounding error of the law, relative to max(1, |u|) at the centre of the region.
  double law_error_ = 0.0;
  // Distance of the corners of the box from its centre.
  double reach_;
  // Rows outside the active set that are tight everywhere.
  std::vector<std::uint16_t> idle_;
  std::vector<double> rows_;  // (a, b)
  std::vector<RowOrigin> origins_;
  // Lengths by which rows_ were divided. 1 for rows of the domain.
  std::vector<double> lengths_;
  // Least value in the box of a slack whose plane does not meet the box.
  double nearest_miss_ = 0.0;
  // Rows in the plane of a facet.
  std::vector<int> changes_;
  // A point in a facet.
  std::vector<double> crossing_;  // p
  std::vector<double> column_;
  std::vector<char> is_active_;
  std::vector<double> scratch_, at_point_;
  PolytopeSolver solver_;
  MinimalRows minimal_;
  FloatLp near_solver_;
};

}  // namespace polyfly
