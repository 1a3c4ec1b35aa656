#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace polyfly {

class RegionMap;

/// The quadratic program that a map was made from, solved online: what the explicit law must equal. A map of a minimum-peak
/// robust MPC is not solved again; `offline_mpt verify --exact` proves it.
class OnlineAxis {
 public:
  /// Throws Error naming the map when its problem text cannot be read.
  explicit OnlineAxis(const RegionMap& map);
  ~OnlineAxis();

  bool solves() const { return program_ != nullptr; }

  /// First input at `theta`, none if the solver finds no solution. The last answer is kept for the same
  /// theta. Only where the axis solves.
  std::optional<double> input(const double* theta);

 private:
  class Program;
  std::size_t size_;
  std::unique_ptr<Program> program_;
  std::vector<double> last_theta_;
  std::optional<double> last_;
};

}  // namespace polyfly
