#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "validation/online_oracle.hpp"

namespace polyfly {

class RegionMap;

/// The program that a map was made from, solved online: what the explicit law must equal.
class OnlineAxis {
 public:
  /// Throws Error naming the map when its problem text cannot be read.
  explicit OnlineAxis(const RegionMap& map, const OracleMaker& maker = {});

  /// First input at `theta`, none if the solver finds no solution. The last answer is kept for the same
  /// theta.
  std::optional<double> input(const double* theta);

 private:
  std::size_t size_;
  OnlineOracle oracle_;
  std::vector<double> last_theta_;
  std::optional<double> last_;
};

}  // namespace polyfly
