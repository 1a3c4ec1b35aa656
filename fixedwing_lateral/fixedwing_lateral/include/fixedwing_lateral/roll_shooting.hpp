#pragma once

#include <array>

#include "fixedwing_lateral/horizon_qp.hpp"
#include "fixedwing_lateral/model.hpp"

namespace polyfly {

/// What one interval of shooting gives: the step of `integrate` and its derivatives, in the form of
/// HorizonStage.
struct ShootingResult {
  /// State (n, e, psi, phi, p) at the end of the interval.
  double end[5];
  /// Rise of x_sw over the interval.
  double switch_rise = 0.0;
};

/// The Runge-Kutta step of model.hpp with its derivatives. It uses that the roll loop is linear, that psi depends on
/// roll alone, and the position on psi alone. The numbers are those of `integrate` (tested) for a tenth of the work.
class RollShooting {
 public:
  RollShooting(const LateralModel& model, double step) noexcept;

  /// The roll loop over one step.
  const RollTransition& transition() const noexcept { return transition_; }

  /// Fills the derivatives of `stage`; its gap and cost are left alone.
  ShootingResult shoot(const LateralConditions& conditions, const LateralState& state, double roll_reference,
                       HorizonStage& stage) const noexcept;

 private:
  struct RollStage {  // phi at a stage of the step, as a combination
    double phi, p, u;
  };

  double switchRise(const LateralConditions& conditions, const LateralState& state,
                    const std::array<double, 4>& cosines, const std::array<double, 4>& sines) const noexcept;

  LateralModel model_;
  double step_ = 0.0;
  RollTransition transition_;
  std::array<RollStage, 4> roll_;
};

}  // namespace polyfly
