#include "online_controller/laws/law_switch.hpp"

#include <utility>

#include "online_controller/types/valid.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

std::vector<std::unique_ptr<ControlLaw>> alone(std::unique_ptr<ControlLaw> law) {
  std::vector<std::unique_ptr<ControlLaw>> laws;
  laws.push_back(std::move(law));
  return laws;
}

/// The delay is the vehicle's: where the first law states none, as the nonlinear one, another law's problems may.
VehicleModel modelToPredict(const std::vector<std::unique_ptr<ControlLaw>>& laws, Law first) {
  const auto place = static_cast<std::size_t>(first);
  if (place >= laws.size() || laws[place] == nullptr)
    throw Error("law: the one that is to fly first is not there");
  VehicleModel model = laws[place]->model();
  for (const auto& law : laws) {
    if (law != nullptr && model.delay == 0.0) model.delay = law->model().delay;
  }
  return model;
}

}  // namespace

LawSwitch::LawSwitch(std::unique_ptr<ControlLaw> law, const MultirotorOptions& options)
    : LawSwitch(alone(std::move(law)), Law{}, options) {}

LawSwitch::LawSwitch(std::vector<std::unique_ptr<ControlLaw>> laws, Law first,
                     const MultirotorOptions& options)
    : laws_(std::move(laws)),
      active_(first),
      options_(options),
      failsafe_(options),
      predictor_(modelToPredict(laws_, first), options) {
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
  const VehicleState ahead = predictor_.ahead(state);
  const ControlReport& report = current().step(ahead, preview);
  if (isAnswer(report.status)) {
    failsafe_.answered();
  } else {
    Substitute sent{report.stamp, report.status, report.reason, report.command, true};
    sent.status = failsafe_.next(sent.command, report.level_trim);
    current().sendInstead(sent);
  }
  inactive_behind_ = true;
  last_state_ = ahead;
  sent_ = report.command;
  return remembered(report);
}

void LawSwitch::syncInactive() noexcept {
  if (!inactive_behind_) return;
  inactive_behind_ = false;
  for (const auto& law : laws_) {
    if (law != nullptr && law.get() != &current()) law->track(last_state_, sent_);
  }
}

const ControlReport& LawSwitch::sendFromAll(const Substitute& sent) noexcept {
  for (const auto& law : laws_) {
    if (law != nullptr) law->sendInstead(sent);
  }
  return remembered(report());
}

const ControlReport& LawSwitch::stepWithoutReference(double stamp) noexcept {
  syncInactive();
  failsafe_.forget();
  return sendFromAll({stamp, ControlStatus::kNoReference, ControlReason::kNoReference,
                      levelCommand(options_, report().level_trim)});
}

// The inactive laws miss the sample, as they would if it had been lost.
const ControlReport& LawSwitch::withoutSample(double stamp, ControlReason reason) noexcept {
  syncInactive();
  Substitute sent{stamp, ControlStatus::kHoldLast, reason, report().command};
  sent.status = failsafe_.next(sent.command, report().level_trim);
  current().sendInstead(sent);
  return remembered(report());
}

const ControlReport& LawSwitch::onSilence(double now) noexcept {
  syncInactive();
  Substitute sent{now, ControlStatus::kLevel, ControlReason::kStale, report().command};
  sent.status = failsafe_.nextInSilence(sent.command, report().level_trim);
  return sendFromAll(sent);
}

void LawSwitch::forget(LawMemory what) noexcept {
  if (what == LawMemory::kAll) {
    inactive_behind_ = false;
    failsafe_.forget();
    predictor_.reset();
  } else {
    syncInactive();
  }
  if (what == LawMemory::kObserver) predictor_.restart();
  for (const auto& law : laws_) {
    if (law != nullptr) law->forget(what);
  }
}

void LawSwitch::setDisturbance(const Eigen::Vector3d& disturbance) noexcept {
  syncInactive();
  predictor_.setDisturbance(disturbance);
  for (const auto& law : laws_) {
    if (law != nullptr) law->setDisturbance(disturbance);
  }
}

void LawSwitch::correct(const AttitudeCommand& sent) noexcept {
  predictor_.sent(report().stamp, sent);
  sent_ = sent;
  current().correct(last_state_, sent);
}

void LawSwitch::track(const VehicleState& state, const AttitudeCommand& sent) noexcept {
  syncInactive();
  const VehicleState ahead = predictor_.ahead(state);
  predictor_.sent(state.stamp, sent);
  for (const auto& law : laws_) {
    if (law != nullptr) law->track(ahead, sent);
  }
  if (isValid(state)) failsafe_.answered();
}

}  // namespace polyfly
