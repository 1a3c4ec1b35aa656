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
  catchUp();
  active_ = law;
  return true;
}

const ControlReport& LawSwitch::step(const VehicleState& state, const Reference* preview) noexcept {
  catchUp();
  const ControlReport& report = current().step(state, preview);
  behind_ = true;
  followed_ = state;
  sent_ = report.command;
  return report;
}

void LawSwitch::catchUp() noexcept {
  if (!behind_) return;
  behind_ = false;
  for (const auto& law : laws_) {
    if (law != nullptr && law.get() != &current()) law->follow(followed_, sent_);
  }
}

const ControlReport& LawSwitch::stepWithoutReference(double stamp) noexcept {
  catchUp();
  for (const auto& law : laws_) {
    if (law != nullptr) law->stepWithoutReference(stamp);
  }
  return report();
}

// The laws that follow miss the sample, as they would if it had been lost.
const ControlReport& LawSwitch::withoutSample(double stamp, ControlReason reason) noexcept {
  catchUp();
  return current().withoutSample(stamp, reason);
}

void LawSwitch::restartObserver() noexcept {
  catchUp();
  for (const auto& law : laws_) {
    if (law != nullptr) law->restartObserver();
  }
}

void LawSwitch::setDisturbance(const Eigen::Vector3d& disturbance) noexcept {
  catchUp();
  for (const auto& law : laws_) {
    if (law != nullptr) law->setDisturbance(disturbance);
  }
}

void LawSwitch::resetIntegrator() noexcept {
  catchUp();
  for (const auto& law : laws_) {
    if (law != nullptr) law->resetIntegrator();
  }
}

const ControlReport& LawSwitch::onSilence(double now) noexcept {
  catchUp();
  for (const auto& law : laws_) {
    if (law != nullptr) law->onSilence(now);
  }
  return report();
}

void LawSwitch::follow(const VehicleState& state, const AttitudeCommand& sent) noexcept {
  catchUp();
  for (const auto& law : laws_) {
    if (law != nullptr) law->follow(state, sent);
  }
}

void LawSwitch::reset() noexcept {
  behind_ = false;
  for (const auto& law : laws_) {
    if (law != nullptr) law->reset();
  }
}

}  // namespace polyfly
