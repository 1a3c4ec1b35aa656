#pragma once

#include <vector>

#include "identification/fit_loop.hpp"
#include "linear_part.hpp"

namespace polyfly {

/// Logarithms of tau, or of omega and zeta; then the delay, if it is looked for.
using ShapeUnknowns = std::vector<double>;

/// The unknown shape and its box.
class ShapeSpace {
 public:
  explicit ShapeSpace(const FitOptions& options);

  LoopShape shape(const ShapeUnknowns& at) const;

  /// Whether the delay cannot fall further, or is not looked for.
  bool delayAtBound(const ShapeUnknowns& at) const;

  const ShapeUnknowns& lower() const { return lower_; }
  const ShapeUnknowns& upper() const { return upper_; }

 private:
  void add(double least, double greatest);

  FitOptions options_;
  ShapeUnknowns lower_;
  ShapeUnknowns upper_;
};

/// Least loss over the shape; what is linear is solved for at every point.
struct ShapeSearch {
  const ShapeSpace* space;
  LinearPart* part;
  /// Scale of the residuals, in the response's unit.
  double scale;

  ShapeUnknowns global(int evaluations);
  ShapeUnknowns local(int evaluations, const ShapeUnknowns& start);
};

}  // namespace polyfly
