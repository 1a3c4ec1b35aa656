#pragma once

#include <gmpxx.h>

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace polyfly {

/// A tracking problem of one bounded input in discrete time, x+ = A x + B u, solved at one state with 180 digits: in the inputs
/// themselves, by an active set that fulfils the conditions of optimality. It shares no code with the solver.
struct BoundedTracking {
  using Real = mpf_class;
  using Matrix = std::vector<std::vector<double>>;

  Matrix A;
  std::vector<double> B, Q;
  double R = 1.0;
  /// Diagonal terminal weight; empty: that of the Riccati equation.
  std::vector<double> terminal;
  /// x_N = 0
  bool ends_at_zero = false;
  int horizon = 2;
  double limit = 1.0;          ///< |u| <= limit
  std::vector<double> ranges;  ///< |x_i| <= ranges[i] in the map

  /// The problem file.
  std::string text() const;
  /// u at x.
  double law(const std::vector<double>& x) const;
};

}  // namespace polyfly
