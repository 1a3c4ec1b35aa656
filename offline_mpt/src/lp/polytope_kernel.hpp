#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "lp/polytope.hpp"

namespace polyfly {

/// The maximum of direction . t over rows in the box [-1, 1]^n, or what shows that there is none.
struct BoxOptimum {
  enum class Status { kOptimal, kInfeasible, kFailed };
  std::vector<double> t;
  /// Rows that are tight at t, as many as dimensions. The sides of the box follow the rows: t_j <= 1 is `count` + 2 j,
  /// -t_j <= 1 the next.
  std::vector<int> basis;
  /// Rows with weights > 0, whose combination is `direction`. Among rows that nearly repeat each other these may lose
  /// most of their digits; the maximum does not. Where the rows exclude each other, the combination of these is
  /// 0 . t <= negative.
  std::vector<std::pair<int, double>> weights;
};

/// What PolytopeSolver asks a dictionary, in a dimension that the compiler knows. False, or kFailed, where rounding
/// leads the pivots astray.
class PolytopeSolver::Kernel {
 public:
  virtual ~Kernel() = default;
  virtual bool minimal(const double* rows, int count, const double* interior, double tolerance,
                       MinimalRows& result) = 0;
  virtual bool minimalBeside(int kept, const double* rows, int count, const double* interior,
                             double tolerance, MinimalRows& result, const LooseRows& loose) = 0;
  /// Maximises direction . t from `start`, which must satisfy every row; `point` receives the maximiser.
  virtual bool maximise(const double* rows, int count, const double* start, const double* direction,
                        double* point) = 0;
  /// As `maximise`, straight towards the maximiser.
  virtual bool climb(const double* rows, int count, const double* start, const double* direction,
                     double* point) = 0;
  /// Of `rows` in one dimension less, the first of which are those of the box: centre and radius of the
  /// largest ball, `hopeless` where its radius is below -kHopelessRadius for certain.
  enum class Ball { kFound, kHopeless, kFailed };
  virtual Ball ballInBox(const double* rows, int count, double* ball) = 0;
  /// No point inside need be known, and there may be none.
  virtual BoxOptimum::Status maximiseInBox(const double* rows, int count, const double* direction,
                                           BoxOptimum& optimum) = 0;
  virtual unsigned long long pivots() const = 0;
};

/// For 1 to PolytopeSolver::kMaxDimension + 1 dimensions; otherwise nothing.
std::unique_ptr<PolytopeSolver::Kernel> makeKernel(int dimension);

}  // namespace polyfly
