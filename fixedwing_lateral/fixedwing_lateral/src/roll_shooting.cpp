#include "fixedwing_lateral/roll_shooting.hpp"

#include <cmath>

namespace polyfly {
namespace {

using Index = LateralIndex;

constexpr std::array<double, 4> kStageTime = {0.0, 0.5, 0.5, 1.0};
constexpr std::array<double, 4> kStageWeight = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};

}  // namespace

RollShooting::RollShooting(const LateralModel& model, double step) noexcept : step_(step) {
  const Eigen::Matrix<double, 2, 3> start = Eigen::Matrix<double, 2, 3>::Identity();
  Eigen::Matrix<double, 2, 3> rate = Eigen::Matrix<double, 2, 3>::Zero();
  end_ = start;
  for (int i = 0; i < 4; ++i) {
    const Eigen::Matrix<double, 2, 3> at = start + kStageTime[i] * step * rate;
    roll_[i] = at.row(0);
    rate.row(0) = at.row(1);
    rate.row(1) = -model.a0 * at.row(0) - model.a1 * at.row(1);
    rate(1, 2) += model.b0;
    end_ += kStageWeight[i] * step * rate;
  }
}

ShootingResult RollShooting::shoot(const LateralConditions& conditions, const LateralState& state,
                                   double roll_reference, HorizonStage& stage) const noexcept {
  const Eigen::Vector3d roll(state[Index::kRoll], state[Index::kRollRate],
                             roll_reference + conditions.roll_bias);
  const double turn = conditions.turn_gain * kGravity / conditions.airspeed;  // psi' by tan(phi)
  std::array<double, 4> cosines{};
  std::array<double, 4> sines{};
  Eigen::Vector2d along = Eigen::Vector2d::Zero();
  double turned = 0.0;
  double rate = 0.0;  // psi' at the stage before
  // Derivatives by (phi, p, u) of n, e, psi, phi and p at the end, and of psi' at the stage before.
  Eigen::Matrix<double, 5, 3> by = Eigen::Matrix<double, 5, 3>::Zero();
  Eigen::RowVector3d slope = Eigen::RowVector3d::Zero();
  for (int i = 0; i < 4; ++i) {
    const double time = kStageTime[i] * step_;
    const double weight = kStageWeight[i] * step_;
    const double heading = state[Index::kHeading] + time * rate;
    const double reach = weight * conditions.airspeed;
    cosines[i] = std::cos(heading);
    sines[i] = std::sin(heading);
    along += reach * Eigen::Vector2d(cosines[i], sines[i]);
    by.row(0) -= reach * sines[i] * time * slope;
    by.row(1) += reach * cosines[i] * time * slope;
    const double tangent = std::tan(roll_[i].dot(roll));
    rate = turn * tangent + conditions.turn_bias;
    slope = turn * (1.0 + tangent * tangent) * roll_[i];
    turned += weight * rate;
    by.row(2) += weight * slope;
  }
  by.bottomRows<2>() = end_;
  stage.A(0, HorizonStage::kHeading) = -along.y();
  stage.A(1, HorizonStage::kHeading) = along.x();
  stage.A.rightCols<2>() = by.leftCols<2>();
  stage.B = by.col(2);

  ShootingResult result;
  result.end << state.head<2>() + along + step_ * conditions.wind, state[Index::kHeading] + turned,
      end_ * roll;
  result.switch_rise = switchRise(conditions, state, cosines, sines);
  return result;
}

// x_sw' at the stages: alpha where x_sw is past the threshold or the condition is met.
double RollShooting::switchRise(const LateralConditions& conditions, const LateralState& state,
                                const std::array<double, 4>& cosines,
                                const std::array<double, 4>& sines) const noexcept {
  if (hasSwitched(state)) return step_ * kSwitchRate;
  const Eigen::Vector2d position = state.head<2>();
  const double farthest = step_ * (conditions.airspeed + conditions.wind.norm());
  if (conditions.gate.isOutOfReach(position, farthest)) return 0.0;
  double rate = 0.0;
  double rise = 0.0;
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();
  for (int i = 0; i < 4; ++i) {
    const double time = kStageTime[i] * step_;
    const Eigen::Vector2d place = position + time * velocity;
    velocity = conditions.airspeed * Eigen::Vector2d(cosines[i], sines[i]) + conditions.wind;
    const bool switching =
        state[Index::kSwitch] + time * rate > kSwitchThreshold || conditions.gate.isMet(place, velocity);
    rate = switching ? kSwitchRate : 0.0;
    rise += kStageWeight[i] * step_ * rate;
  }
  return rise;
}

}  // namespace polyfly
