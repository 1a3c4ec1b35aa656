#pragma once

#include <Eigen/Core>
#include <optional>

#include "mpc_core/dense_qp.hpp"
#include "mpc_core/parametric_program.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// The program that a map was made from, solved online: what the explicit law must equal.
class OnlineAxis {
 public:
  /// Throws Error naming the map when its problem text cannot be read.
  explicit OnlineAxis(const RegionMap& map);

  /// First input at `theta`, none if the solver finds no solution.
  std::optional<double> input(const double* theta);

 private:
  ParametricProgram program_;
  DenseQp solver_;
  Eigen::VectorXd gradient_;
  Eigen::VectorXd bounds_;
};

}  // namespace polyfly
