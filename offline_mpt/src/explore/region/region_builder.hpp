#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "explore/region/high_precision_region.hpp"
#include "explore/region/shortest_optimum.hpp"
#include "explore/sets/active_set_list.hpp"
#include "offline_mpt/polytope.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Row indices of a NormalisedProgram, ascending.
using ActiveSet = std::vector<std::uint16_t>;

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
};

/// Where the way from the region's centre, 0, to the point beyond the facet, 1, crosses it.
double crossingFraction(const Region& region, const Facet& facet);

enum class BuildStatus : std::uint8_t {
  kRegion,            ///< full-dimensional
  kEmptyInterior,     ///< empty or flatter than the tolerance
  kLowerDimensional,  ///< thin, but the way to what lies behind may lead through it alone
  kDependent,         ///< the active rows are linearly dependent
  kWeaklyActive,      ///< a multiplier is zero everywhere: the set without it is the same
  kFailed,            ///< the simplex gave up
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

 private:
  bool findMultipliers(const ActiveSet& active, double& scale);
  bool findShortest(const ActiveSet& active);
  double growth() const;
  BuildStatus measure(const ActiveSet& active, Region& region);
  /// Even estimates of errors do.
  bool isIllConditioned() const { return doubtful_ || pivot_ < kDistant; }
  bool isFlat(const Region& region) const;
  BuildStatus findFacets(const ActiveSet& active, double tolerance, Region& region);
  BuildStatus inflateFlat(const ActiveSet& active, Region& region);
  bool needsAccuracy(BuildStatus status, const Region& region) const;
  bool describeAccurately(const ActiveSet& active);
  bool holdsAsDescribed(const ActiveSet& active, const double* t, double tolerance);
  void slackRow(const ActiveSet& active, int row);
  void clearRows();
  bool satisfied(const double* t, double tolerance) const;
  bool holdsSlacks(const ActiveSet& active, const double* t, double tolerance, double scale);
  bool factorise(const ActiveSet& active);
  bool factoriseAccurately(const ActiveSet& active);
  void solveFactor(double* x, std::size_t rows, std::size_t width) const;
  BuildStatus assembleRows(const ActiveSet& active);
  bool addRow(const double* affine, RowOrigin origin, double scale, double noise, BuildStatus& status);
  void law(const ActiveSet& active, std::vector<double>& out);
  bool depends(const ActiveSet& active, int row);
  void findChanges(const Facet& facet);
  void cross(const ActiveSet& active, const Region& region, const Facet& facet);
  int exchange(const ActiveSet& active, int row, ActiveSetList& sets) const;
  bool beginsBehind(const ActiveSet& active, int leaving);
  bool slacksStay(int facet, double change) const;
  void combine(const ActiveSet& active, ActiveSetList& sets);
  double valueOf(const double* affine, const double* t) const;
  void enter(const ActiveSet& active, int leaving, ActiveSetList& sets) const;
  BuildStatus addMultiplierRows(const ActiveSet& active, double scale);
  BuildStatus addSlackRows(const ActiveSet& active, double scale);
  bool findCostMultipliers(const ActiveSet& active);

  static constexpr double kAccurate = 1e-9;     // error of a plane or law that is left to doubles
  static constexpr double kErrorMargin = 10.0;  // by how much an estimated error may be too small
  /// Squared distance from others below which products of unit rows mislead.
  static constexpr double kSafePivot = 1e-6;
  static constexpr double kIndependent = 1e-10;  // distance of a unit row from the span of the others
  static constexpr double kDistant = 1e-7;       // the same, below which estimates of errors mislead too
  /// Residual of the cost outside the span of the active rows, relative to its largest entry.
  static constexpr double kCostResidual = 1e-9;

  const NormalisedProgram& program_;
  double facet_tolerance_;
  double radius_tolerance_;
  int width_;                 // p + 1
  std::vector<double> gram_;  // row-major copies, so that the inner loops run along memory
  std::vector<double> D_;
  std::vector<double> M_;
  std::vector<double> factor_;            // lower triangle, k x k
  std::vector<double> inverse_;           // of its diagonal
  std::vector<double> multipliers_;       // k x (p + 1)
  std::vector<double> cost_multipliers_;  // as multipliers_, of a linear program
  double size_ = 0.0;                     // greatest of multipliers_
  double pivot_ = 1.0;                    // least of the factor's diagonal
  ShortestOptimum shortest_;              // describes the set where H is singular and not zero
  bool cost_spanned_ = true;              // by cost multipliers, there
  HighPrecisionRegionSolver accurate_;
  bool is_accurate_ = false;         // the set is described by accurate_
  bool doubtful_ = false;            // rounding decided whether a row is constant
  double plane_error_ = 0.0;         // about what rounding does to the half-spaces in the box [scaled]
  double law_error_ = 0.0;           // the same for the law, relative to max(1, |u|)
  std::vector<double> D_size_;       // greatest |entry| of each row of D
  std::vector<double> U_size_;       // the same of U
  double reach_;                     // distance of the box's corners
  std::vector<std::uint16_t> idle_;  // rows outside the set that are tight everywhere
  std::vector<double> rows_;         // (a, b)
  std::vector<RowOrigin> origins_;
  std::vector<double> lengths_;   // what rows_ were divided by; of the domain's, 1
  double nearest_miss_ = 0.0;     // least value in the box of a slack that does not meet it
  std::vector<int> changes_;      // rows in the plane of a facet
  std::vector<double> weights_;   // of the active rows, in a row that depends on them
  std::vector<double> crossing_;  // p, in a facet
  std::vector<double> column_;
  std::vector<char> is_active_;
  std::vector<double> scratch_, at_point_;
  PolytopeSolver solver_;
  MinimalRows minimal_;
};

}  // namespace polyfly
