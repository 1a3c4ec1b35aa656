#include "fixedwing_lateral/lateral_nmpc.hpp"

#include <algorithm>
#include <cmath>

#include "fixedwing_lateral/tracking_cost.hpp"

namespace polyfly {
namespace {

// Moves that the greatest roll rate does not bound. With 0 or 1 of them the path is lost in gusts; 2 to 6 make no difference.
constexpr int kFreeMoves = 3;

using Index = LateralIndex;

constexpr double kTurn = 2.0 * kPi;
// Where each state of the quadratic program is in a LateralState.
constexpr int kOrder[] = {Index::kNorth, Index::kEast, Index::kHeading, Index::kRoll, Index::kRollRate};

HorizonStage::State stageState(const LateralState& state) noexcept {
  HorizonStage::State ordered;
  for (int i = 0; i < 5; ++i) ordered[i] = state[kOrder[i]];
  return ordered;
}

}  // namespace

LateralNmpc::LateralNmpc(const LateralModel& model, const HorizonOptions& options, const std::string& where)
    : model_((checkModel(model, where), checkHorizon(options, where), model)),
      N_(options.horizon),
      step_(options.step),
      shooting_(model, options.step),
      slew_(N_),
      qp_(N_),
      nodes_(N_ + 1, LateralState::Zero()),
      moves_(N_),
      previous_(N_),
      switch_rise_(N_),
      roll_along_(N_ + 1),
      input_along_(N_ + 1) {
  setTuning(LateralWeights{}, LateralLimits{});
}

void LateralNmpc::setTuning(const LateralWeights& weights, const LateralLimits& limits) noexcept {
  weights_ = weights;
  limits_ = limits;
  for (int k = 0; k < N_; ++k) {
    const double left = 1.0 - static_cast<double>(k) / N_;
    slew_[k] = weights.slew * left * left;
  }
}

void LateralNmpc::reset(const HorizonData& data, const LateralState& state, double roll_reference) noexcept {
  const double held = std::clamp(roll_reference, -limits_.roll_reference, limits_.roll_reference);
  std::fill(moves_.begin(), moves_.end(), held);
  std::fill(previous_.begin(), previous_.end(), held);
  nodes_[0] = state;
  for (int k = 0; k < N_; ++k)
    nodes_[k + 1] = integrate(model_, data.conditions, nodes_[k], {moves_[k], step_});
  qp_.coldStart();
  prepared_ = false;
}

void LateralNmpc::keepAsPrevious(double steps) noexcept {
  const double bounded = std::clamp(steps, 0.0, static_cast<double>(N_));
  const int whole = static_cast<int>(bounded);
  const double part = bounded - whole;
  for (int k = 0; k < N_; ++k) {
    const double before = moves_[std::min(k + whole, N_ - 1)];
    const double after = moves_[std::min(k + whole + 1, N_ - 1)];
    previous_[k] = before + part * (after - before);
  }
}

void LateralNmpc::clearSwitch() noexcept {
  for (LateralState& node : nodes_) node[Index::kSwitch] = 0.0;
}

bool LateralNmpc::prepare(const HorizonData& data) noexcept {
  linearise(data);
  setBounds();
  kkt_ = stationarity();
  prepared_ = std::isfinite(cost_) && qp_.prepare();
  return prepared_;
}

void LateralNmpc::linearise(const HorizonData& data) noexcept {
  const TrackingCost tracking(data, weights_);
  cost_ = 0.0;
  largest_track_error_ = 0.0;
  HorizonStage* stages = qp_.stages();
  for (int k = 0; k < N_; ++k) {
    HorizonStage& stage = stages[k];
    const ShootingResult shot = shooting_.shoot(data.conditions, nodes_[k], moves_[k], stage);
    stage.gap = shot.end - stageState(nodes_[k + 1]);
    switch_rise_[k] = shot.switch_rise;
    addRoll(k, tracking.linearise(nodes_[k], stage), data.conditions.roll_bias);
    const double deviation = moves_[k] - previous_[k];
    const double turning = moves_[k] - input_along_[k];
    stage.R = weights_.roll_reference + slew_[k];
    stage.r = weights_.roll_reference * turning + slew_[k] * deviation;
    cost_ += weights_.roll_reference * turning * turning + slew_[k] * deviation * deviation;
  }
  addRoll(N_, tracking.linearise(nodes_[N_], stages[N_]), data.conditions.roll_bias);
}

// The cost of a stage and its part in phi, which is counted from roll_along_.
void LateralNmpc::addRoll(int k, const StageTerms& terms, double roll_bias) noexcept {
  const double limit = limits_.roll_reference;
  largest_track_error_ = std::max(largest_track_error_, terms.track_error);
  const double holding = model_.a0 / model_.b0 * terms.roll_along - weights_.feedforward * roll_bias;
  roll_along_[k] = std::clamp(terms.roll_along, -limit, limit);
  input_along_[k] = std::clamp(holding, -limit, limit);
  const double roll = nodes_[k][Index::kRoll] - roll_along_[k];
  qp_.stages()[k].q[HorizonStage::kRoll] = weights_.roll * roll;
  cost_ += terms.cost + weights_.roll * roll * roll;
}

// The roll loop settles at the rate (b0 phi_r - a0 phi) / a1. So the greatest rate is a bound of phi_r about the roll,
// which is taken from the last iteration: all of them stay boxes. The first moves are free: they answer to the measured roll,
// which is not the predicted one in gusts.
Interval LateralNmpc::moveBound(int k) const noexcept {
  const double limit = limits_.roll_reference;
  if (!(model_.roll_rate_max > 0.0) || k < kFreeMoves) return {-limit, limit};
  const double holding = std::clamp(model_.a0 / model_.b0 * nodes_[k][Index::kRoll], -limit, limit);
  const double room = model_.a1 / model_.b0 * model_.roll_rate_max;
  return {std::max(-limit, holding - room), std::min(limit, holding + room)};
}

void LateralNmpc::setBounds() noexcept {
  Interval* moves = qp_.moveBounds();
  Interval* rolls = qp_.rollBounds();
  for (int k = 0; k < N_; ++k) {
    const Interval bound = moveBound(k);
    moves[k] = {bound.lower - moves_[k], bound.upper - moves_[k]};
    const double roll = nodes_[k + 1][Index::kRoll];
    rolls[k] = {-limits_.roll - roll, limits_.roll - roll};
  }
}

// The gradient of the Lagrangian by the moves, at the nodes and with the roll bounds' last multipliers; where
// a move is at its bound, the part that pushes outwards does not count.
double LateralNmpc::stationarity() noexcept {
  HorizonStage* stages = qp_.stages();
  const double* multipliers = qp_.multipliers();
  double largest = 0.0;
  HorizonStage::State y = stages[N_].q;
  for (int k = N_ - 1; k >= 0; --k) {
    HorizonStage& s = stages[k];
    // Of position by heading the second derivatives are the first ones of the other axis.
    constexpr int kHeading = HorizonStage::kHeading;
    const double bend = y[1] * s.A(0, kHeading) - y[0] * s.A(1, kHeading);
    s.Q(kHeading, kHeading) += weights_.curvature * std::max(bend, 0.0);
    y[HorizonStage::kRoll] += multipliers[N_ + k];
    double gradient = s.r + s.B.dot(y);
    const Interval& bound = qp_.moveBounds()[k];
    if (bound.upper <= 0.0) gradient = std::max(gradient, 0.0);
    if (bound.lower >= 0.0) gradient = std::min(gradient, 0.0);
    largest = std::max(largest, std::abs(gradient));
    y = (s.A.transpose() * y + s.q).eval();
    largest = std::max(largest, s.gap.cwiseAbs().maxCoeff());
  }
  return largest;
}

NmpcReport LateralNmpc::feedback(const LateralState& state) noexcept {
  NmpcReport report;
  report.status = QpStatus::kNotFinite;
  report.kkt = kkt_;
  report.cost = cost_;
  if (!prepared_) return report;
  prepared_ = false;
  HorizonStage::State deviation = stageState(state) - stageState(nodes_[0]);
  deviation[HorizonStage::kHeading] = std::remainder(deviation[HorizonStage::kHeading], kTurn);
  report.status = qp_.solve(deviation.data());
  report.active_bounds = qp_.activeCount();
  if (!report.hasMoves()) return report;
  nodes_[0][Index::kSwitch] = state[Index::kSwitch];
  takeStep();
  return report;
}

void LateralNmpc::takeStep() noexcept {
  const double* moves = qp_.moves();
  for (int k = 0; k <= N_; ++k) {
    for (int i = 0; i < 5; ++i) nodes_[k][kOrder[i]] += qp_.states()[k][i];
    if (k < N_) {
      moves_[k] = std::clamp(moves_[k] + moves[k], -limits_.roll_reference, limits_.roll_reference);
      nodes_[k + 1][Index::kSwitch] = nodes_[k][Index::kSwitch] + switch_rise_[k];
    }
  }
}

}  // namespace polyfly
