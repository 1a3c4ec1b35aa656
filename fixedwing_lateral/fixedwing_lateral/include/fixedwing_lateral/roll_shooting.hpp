#pragma once

#include <array>

#include "fixedwing_lateral/horizon_qp.hpp"
#include "fixedwing_lateral/model.hpp"

namespace polyfly {

/// The end of one interval of shooting.
struct ShootingResult {
  /// State at the end of the interval.
  HorizonStage::State end;
  /// Rise of x_sw over the interval.
  double switch_rise = 0.0;
};

/// The Runge-Kutta step of model.hpp with its derivatives. It uses that the roll loop is linear, that psi depends on
/// roll alone, and the position on psi alone. The numbers are those of `integrate` (tested) for a tenth of the work.
class RollShooting {
 public:
  RollShooting(const LateralModel& model, double step) noexcept;

  /// Fills A and B of `stage`; its gap and cost are left alone.
  ShootingResult shoot(const LateralConditions& conditions, const LateralState& state, double roll_reference,
                       HorizonStage& stage) const noexcept;

 private:
  double switchRise(const LateralConditions& conditions, const LateralState& state,
                    const std::array<double, 4>& cosines, const std::array<double, 4>& sines) const noexcept;

  double step_ = 0.0;
  // Roll at the four stages, and roll and roll rate at the end, by (phi, p, u).
  std::array<Eigen::RowVector3d, 4> roll_;
  Eigen::Matrix<double, 2, 3> end_;
};

}  // namespace polyfly
