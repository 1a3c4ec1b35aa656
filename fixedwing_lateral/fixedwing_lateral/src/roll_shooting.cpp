#include "fixedwing_lateral/roll_shooting.hpp"

#include <cmath>

namespace polyfly {
namespace {

using Index = LateralIndex;

constexpr std::array<double, 4> kStageTime = {0.0, 0.5, 0.5, 1.0};
constexpr std::array<double, 4> kStageWeight = {1.0 / 6.0, 1.0 / 3.0, 1.0 / 3.0, 1.0 / 6.0};

struct Roll {
  double phi, p;
};

Roll rollRate(const LateralModel& model, const Roll& roll, double u) noexcept {
  return {roll.p, model.b0 * u - model.a1 * roll.p - model.a0 * roll.phi};
}

/// The roll at the four stages, and at the end of the step.
std::array<Roll, 5> rollStages(const LateralModel& model, double step, const Roll& start, double u) noexcept {
  std::array<Roll, 5> stages{};
  Roll rate{0.0, 0.0};
  Roll sum{0.0, 0.0};
  for (int i = 0; i < 4; ++i) {
    stages[i] = {start.phi + kStageTime[i] * step * rate.phi, start.p + kStageTime[i] * step * rate.p};
    rate = rollRate(model, stages[i], u);
    sum = {sum.phi + kStageWeight[i] * rate.phi, sum.p + kStageWeight[i] * rate.p};
  }
  stages[4] = {start.phi + step * sum.phi, start.p + step * sum.p};
  return stages;
}

}  // namespace

RollShooting::RollShooting(const LateralModel& model, double step) noexcept : model_(model), step_(step) {
  const std::array<Roll, 5> by_phi = rollStages(model, step, {1.0, 0.0}, 0.0);
  const std::array<Roll, 5> by_p = rollStages(model, step, {0.0, 1.0}, 0.0);
  const std::array<Roll, 5> by_u = rollStages(model, step, {0.0, 0.0}, 1.0);
  for (int i = 0; i < 4; ++i) roll_[i] = {by_phi[i].phi, by_p[i].phi, by_u[i].phi};
  transition_ = {by_phi[4].phi, by_p[4].phi, by_u[4].phi, by_phi[4].p, by_p[4].p, by_u[4].p};
}

ShootingResult RollShooting::shoot(const LateralConditions& conditions, const LateralState& state,
                                   double roll_reference, HorizonStage& stage) const noexcept {
  const double phi = state[Index::kRoll];
  const double p = state[Index::kRollRate];
  const double psi = state[Index::kHeading];
  const double input = roll_reference + conditions.roll_bias;
  const double turn = conditions.turn_gain * kGravity / conditions.airspeed;  // psi' by tan(phi)
  const double half = 0.5 * step_;

  std::array<double, 4> rate{};   // psi' at the stages
  std::array<double, 4> slope{};  // its derivative by phi
  for (int i = 0; i < 4; ++i) {
    const double tangent = std::tan(roll_[i].phi * phi + roll_[i].p * p + roll_[i].u * input);
    rate[i] = turn * tangent + conditions.turn_bias;
    slope[i] = turn * (1.0 + tangent * tangent);
  }
  const std::array<double, 4> headings = {psi, psi + half * rate[0], psi + half * rate[1],
                                          psi + step_ * rate[2]};
  std::array<double, 4> cosines{};
  std::array<double, 4> sines{};
  for (int i = 0; i < 4; ++i) {
    cosines[i] = std::cos(headings[i]);
    sines[i] = std::sin(headings[i]);
  }

  const double sixth = step_ / 6.0;
  const double reach = sixth * conditions.airspeed;
  const double along_n = reach * (cosines[0] + 2.0 * (cosines[1] + cosines[2]) + cosines[3]);
  const double along_e = reach * (sines[0] + 2.0 * (sines[1] + sines[2]) + sines[3]);
  stage.n_psi = -along_e;
  stage.e_psi = along_n;
  // The heading at stage i + 1 moves with the rate at stage i.
  const double w_1 = reach * step_ * slope[0];
  const double w_2 = reach * step_ * slope[1];
  const double w_3 = reach * step_ * slope[2];
  const double phi_1 = w_1 * roll_[0].phi, phi_2 = w_2 * roll_[1].phi, phi_3 = w_3 * roll_[2].phi;
  const double p_1 = w_1 * roll_[0].p, p_2 = w_2 * roll_[1].p, p_3 = w_3 * roll_[2].p;
  const double u_1 = w_1 * roll_[0].u, u_2 = w_2 * roll_[1].u, u_3 = w_3 * roll_[2].u;
  stage.n_phi = -(sines[1] * phi_1 + sines[2] * phi_2 + sines[3] * phi_3);
  stage.n_p = -(sines[1] * p_1 + sines[2] * p_2 + sines[3] * p_3);
  stage.n_u = -(sines[1] * u_1 + sines[2] * u_2 + sines[3] * u_3);
  stage.e_phi = cosines[1] * phi_1 + cosines[2] * phi_2 + cosines[3] * phi_3;
  stage.e_p = cosines[1] * p_1 + cosines[2] * p_2 + cosines[3] * p_3;
  stage.e_u = cosines[1] * u_1 + cosines[2] * u_2 + cosines[3] * u_3;
  const double s_1 = sixth * slope[0], s_2 = 2.0 * sixth * slope[1], s_3 = 2.0 * sixth * slope[2],
               s_4 = sixth * slope[3];
  stage.psi_phi = s_1 * roll_[0].phi + s_2 * roll_[1].phi + s_3 * roll_[2].phi + s_4 * roll_[3].phi;
  stage.psi_p = s_1 * roll_[0].p + s_2 * roll_[1].p + s_3 * roll_[2].p + s_4 * roll_[3].p;
  stage.psi_u = s_1 * roll_[0].u + s_2 * roll_[1].u + s_3 * roll_[2].u + s_4 * roll_[3].u;

  ShootingResult result;
  result.end[0] = state[Index::kNorth] + along_n + step_ * conditions.wind.x();
  result.end[1] = state[Index::kEast] + along_e + step_ * conditions.wind.y();
  result.end[2] = psi + sixth * (rate[0] + 2.0 * (rate[1] + rate[2]) + rate[3]);
  result.end[3] = transition_.phi_phi * phi + transition_.phi_p * p + transition_.phi_u * input;
  result.end[4] = transition_.p_phi * phi + transition_.p_p * p + transition_.p_u * input;
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
