#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace polyfly {

/// Result of removing redundant half-spaces.
struct MinimalRows {
  std::vector<int> facets;  ///< indices of the rows that bound the polytope, ascending
  /// Per facet a point (dimension numbers) that violates this row and no other facet.
  std::vector<double> beyond;
  /// With LooseRows: where all others are violated by at most their amounts, those that are asked and were left out are by at
  /// most so many units. Above LooseRows::most it is no bound.
  double excess = 1.0;
  /// A row was left out although the others let it be violated beyond rounding, by at most the tolerance.
  bool leaves_reach = false;
};

/// Rows that may be violated.
struct LooseRows {
  const double* amounts = nullptr;  ///< one per row: by how much at most
  /// One per row: whether MinimalRows::excess counts it once it is left out.
  const char* is_asked = nullptr;
  double unit = 0.0;
  double most = 0.0;  ///< greatest MinimalRows::excess that is of interest, at least 1
};

/// Linear programming over small dense polytopes {t : a_i . t <= b_i}, in 1 to kMaxDimension dimensions.
///
/// A row is dimension + 1 numbers (a, b) with |a| = 1. The polytope must be bounded. Work space is kept
/// between calls; one object serves one thread. The method is the primal simplex on dictionaries: the slacks
/// of all rows as affine functions of the slacks of the rows that are tight at the current vertex, so that
/// one pivot costs rows x dimension multiply-adds and every vertex passed proves rows redundant or
/// irredundant for free. Where rounding leads the pivots astray, the question is answered once more in
/// rational arithmetic. So false means a polytope that is not bounded, or numbers that are not finite. `minimal`,
/// `minimalBeside` and `furthest` do so too where rounding took the last vertex away from its rows.
class PolytopeSolver {
 public:
  static constexpr int kMaxDimension = 13;

  /// Throws Error when `dimension` is not in 1..kMaxDimension.
  explicit PolytopeSolver(int dimension);
  ~PolytopeSolver();
  PolytopeSolver(PolytopeSolver&&) noexcept;
  PolytopeSolver& operator=(PolytopeSolver&&) noexcept;

  /// Centre and radius of the largest inscribed ball. The radius is negative when the polytope is empty (it
  /// then says by how much). `centre` is read as a guess and overwritten. False when there is none: the
  /// polytope is unbounded. `exactly`: in rational arithmetic, rounded once.
  bool chebyshev(const double* rows, int count, double* centre, double& radius, bool exactly = false);

  /// The same where the first rows are those of the box [-1, 1]^n, t_j <= 1 and -t_j <= 1 in turn, all rows
  /// of unit length; no guess is read. Where the radius is below -tolerance::kHopelessRadius, it is an upper bound and
  /// `centre` has no meaning.
  bool chebyshevInBox(const double* rows, int count, double* centre, double& radius);

  /// Rows that are needed, each by a point that violates it by more than `tolerance` and no other that is
  /// needed. `interior` must lie strictly inside. Of rows that coincide one is kept. False when the
  /// polytope is unbounded.
  bool minimal(const double* rows, int count, const double* interior, double tolerance, MinimalRows& result);

  /// The same for the last rows only: the first `kept` count as needed, without a question, and are not in `result`.
  bool minimalBeside(int kept, const double* rows, int count, const double* interior, double tolerance,
                     MinimalRows& result, const LooseRows& loose = {});

  /// A point where direction . t is greatest; false when there is none. `interior` must lie inside.
  bool support(const double* rows, int count, const double* interior, const double* direction, double* point);

  /// As `support`, with fewer pivots: the first ones already climb. `point` may be another of several maximisers.
  bool furthest(const double* rows, int count, const double* interior, const double* direction,
                double* point);

  /// As `furthest`, in doubles alone: false also where rounding leaves the answer in doubt.
  bool furthestInDoubles(const double* rows, int count, const double* interior, const double* direction,
                         double* point);

  /// Pivots since construction.
  unsigned long long pivots() const;

  /// Implementation, one for each dimension.
  class Kernel;

 private:
  bool minimalOneByOne(int kept, const double* rows, int count, const double* interior, double tolerance,
                       MinimalRows& result);
  bool furthestBeyond(std::vector<double>& rows, std::size_t place, const double* interior, double* point,
                      double& violation);
  bool restoreRows(const double* rows, int count, const double* interior, double tolerance,
                   MinimalRows& result);
  bool renewPoints(const double* rows, const std::vector<int>& restored, const double* interior,
                   double tolerance, MinimalRows& result);
  double radiusAbout(const double* rows, int count, const double* centre) const;

  // Kernel in `dimension`.
  std::unique_ptr<Kernel> plain_;
  // Kernel in `dimension` + 1, for the inscribed ball.
  std::unique_ptr<Kernel> lifted_;
  int dimension_ = 0;
  std::vector<double> lifted_rows_;
};

}  // namespace polyfly
