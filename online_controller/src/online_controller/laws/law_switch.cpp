#include "online_controller/laws/law_switch.hpp"

#include <utility>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr std::array<const char*, kLawCount> kNames{"explicit_linear", "linear", "nonlinear",
                                                    "robust_explicit"};

}  // namespace

const char* lawName(Law law) noexcept { return kNames[static_cast<std::size_t>(law)]; }

Law lawOfName(const std::string& name) {
  std::string known;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (name == kNames[i]) return static_cast<Law>(i);
    known += (i == 0 ? "" : ", ") + std::string(kNames[i]);
  }
  throw Error("law: must be one of " + known + ", got '" + name + "'");
}

LawSwitch::LawSwitch(std::array<std::unique_ptr<ControlLaw>, kLawCount> laws, Law first)
    : laws_(std::move(laws)), active_(first) {
  if (!has(first)) throw Error(std::string("law: ") + lawName(first) + " is not there to fly with");
  for (const auto& law : laws_) {
    if (law == nullptr || law->previewLength() <= preview_length_) continue;
    preview_length_ = law->previewLength();
    preview_period_ = law->previewPeriod();
  }
}

bool LawSwitch::select(Law law) noexcept {
  if (!has(law)) return false;
  syncInactive();
  active_ = law;
  return true;
}

const ControlReport& LawSwitch::step(const VehicleState& state, const Reference* preview) noexcept {
  syncInactive();
  const ControlReport& report = current().step(state, preview);
  inactive_behind_ = true;
  last_state_ = state;
  sent_ = report.command;
  return report;
}

void LawSwitch::syncInactive() noexcept {
  if (!inactive_behind_) return;
  inactive_behind_ = false;
  for (const auto& law : laws_) {
    if (law != nullptr && law.get() != &current()) law->track(last_state_, sent_);
  }
}

const ControlReport& LawSwitch::stepWithoutReference(double stamp) noexcept {
  syncInactive();
  for (const auto& law : laws_) {
    if (law != nullptr) law->stepWithoutReference(stamp);
  }
  return report();
}

// The inactive laws miss the sample, as they would if it had been lost.
const ControlReport& LawSwitch::withoutSample(double stamp, ControlReason reason) noexcept {
  syncInactive();
  return current().withoutSample(stamp, reason);
}

void LawSwitch::restartObserver() noexcept {
  syncInactive();
  for (const auto& law : laws_) {
    if (law != nullptr) law->restartObserver();
  }
}

void LawSwitch::setDisturbance(const Eigen::Vector3d& disturbance) noexcept {
  syncInactive();
  for (const auto& law : laws_) {
    if (law != nullptr) law->setDisturbance(disturbance);
  }
}

void LawSwitch::resetIntegrator() noexcept {
  syncInactive();
  for (const auto& law : laws_) {
    if (law != nullptr) law->resetIntegrator();
  }
}

const ControlReport& LawSwitch::onSilence(double now) noexcept {
  syncInactive();
  for (const auto& law : laws_) {
    if (law != nullptr) law->onSilence(now);
  }
  return report();
}

void LawSwitch::track(const VehicleState& state, const AttitudeCommand& sent) noexcept {
  syncInactive();
  for (const auto& law : laws_) {
    if (law != nullptr) law->track(state, sent);
  }
}

void LawSwitch::reset() noexcept {
  inactive_behind_ = false;
  for (const auto& law : laws_) {
    if (law != nullptr) law->reset();
  }
}

}  // namespace polyfly
