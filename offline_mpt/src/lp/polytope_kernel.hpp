#pragma once

#include <memory>

#include "lp/polytope.hpp"

namespace polyfly {

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
  virtual unsigned long long pivots() const = 0;
};

/// For 1 to PolytopeSolver::kMaxDimension + 1 dimensions; otherwise nothing.
std::unique_ptr<PolytopeSolver::Kernel> makeKernel(int dimension);

}  // namespace polyfly
