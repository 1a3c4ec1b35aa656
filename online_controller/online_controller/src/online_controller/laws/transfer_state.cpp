// How a law made from other options goes on where the one before it is, and what it tells of itself.
#include <algorithm>

#include "online_controller/laws/law_switch.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"

namespace polyfly {
void MultirotorController::transferState(const ControlLaw& from) noexcept {
  const auto* other = dynamic_cast<const MultirotorController*>(&from);
  if (other == nullptr) return;
  for (std::size_t i = 0; i < axes_.size(); ++i) {
    axes_[i].transferState(other->axes_[i]);
    inputs_[i] = other->inputs_[i];
    // Those of a minimum-peak robust MPC are held; for the others see inputOffsets().
    if (axes_[i].problem().minimum_peak)
      inputs_[i] = std::clamp(inputs_[i], axes_[i].inputLower(), axes_[i].inputUpper());
  }
  transferEstimates(*other);
  applied_ = other->applied_;
  feed_forward_ = other->feed_forward_;
  if (clock_.period() == other->clock_.period()) clock_ = other->clock_;
}

void NonlinearController::transferState(const ControlLaw& from) noexcept {
  const auto* other = dynamic_cast<const NonlinearController*>(&from);
  if (other == nullptr) return;
  observer_.transferState(other->observer_);
  transferEstimates(*other);
  yaw_ = other->yaw_;
  has_command_ = other->has_command_;
  prepared_ = false;
  // One that was prepared is shifted to the next sample already, and begins anew.
  iterating_ = other->iterating_ && !other->prepared_ && mpc_.transferState(other->mpc_);
  if (!iterating_) return;
  std::copy(other->stages_.begin(), other->stages_.end(), stages_.begin());
  std::copy(other->references_.begin(), other->references_.end(), references_.begin());
  std::copy(other->preview_.begin(), other->preview_.end(), preview_.begin());
}

void LawSwitch::transferState(const LawSwitch& from) noexcept {
  const std::size_t common = std::min(laws_.size(), from.laws_.size());
  for (std::size_t i = 0; i < common; ++i) {
    if (laws_[i] != nullptr && from.laws_[i] != nullptr) laws_[i]->transferState(*from.laws_[i]);
  }
  if (has(from.active_)) active_ = from.active_;
  predictor_.transferState(from.predictor_);
  inactive_behind_ = from.inactive_behind_;
  last_state_ = from.last_state_;
  sent_ = from.sent_;
  failsafe_.transferState(from.failsafe_);
  if (lead() == from.lead()) return;
  // The next states are those of another time: the observers go on from there.
  syncInactive();
  for (const auto& law : laws_) {
    if (law == nullptr) continue;
    law->forget(LawMemory::kObserver);
    law->forget(LawMemory::kLoops);
  }
  if (from.lead() > 0.0) return;
  const ControlReport& known = report();
  predictor_.setDisturbance(
      {known.axis[0].disturbance, known.axis[1].disturbance, known.axis[2].disturbance});
}

}  // namespace polyfly
