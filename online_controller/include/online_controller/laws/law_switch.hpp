#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "online_controller/laws/control_law.hpp"

namespace polyfly {

/// The laws that a multirotor can fly with.
enum class Law { kExplicitLinear, kLinear, kNonlinear, kRobustExplicit };
constexpr int kLawCount = 4;

/// `explicit_linear`, `linear`, `nonlinear`, `robust_explicit`.
const char* lawName(Law law) noexcept;

/// The law of that name. Throws Error naming what there is.
Law lawOfName(const std::string& name);

/// Several laws behind one. One of them is active, the others track what it sends. So a switch in flight has
/// no bump: the next law's observer is up to date, and its last command is the one that was sent.
class LawSwitch : public ControlLaw {
 public:
  /// Laws in the order of the enumeration, nullptr where there is none; `first` flies first. Throws Error
  /// naming it when it is not there.
  LawSwitch(std::array<std::unique_ptr<ControlLaw>, kLawCount> laws, Law first);

  bool has(Law law) const noexcept { return laws_[static_cast<std::size_t>(law)] != nullptr; }
  Law active() const noexcept { return active_; }

  /// From the next step on. False, and nothing changes, when there is no such law.
  bool select(Law law) noexcept;

  /// The longest preview that one of the laws reads; all of them read the same.
  int previewLength() const noexcept override { return preview_length_; }
  double previewPeriod() const noexcept override { return preview_period_; }
  int previewNeeded() const noexcept override { return current().previewLength(); }

  const ControlReport& step(const VehicleState& state, const Reference* preview) noexcept override;
  /// The inactive laws track here, after the command was sent; without this call, before the next other call.
  void prepare() noexcept override {
    syncInactive();
    current().prepare();
  }
  const ControlReport& stepWithoutReference(double stamp) noexcept override;
  const ControlReport& withoutSample(double stamp, ControlReason reason) noexcept override;
  const ControlReport& onSilence(double now) noexcept override;
  void restartObserver() noexcept override;
  void setDisturbance(const Eigen::Vector3d& disturbance) noexcept override;
  void resetIntegrator() noexcept override;
  void track(const VehicleState& state, const AttitudeCommand& sent) noexcept override;
  void transferState(const ControlLaw& from) noexcept override;
  int predict(const Reference* preview, int count, Eigen::Vector3d* positions) const noexcept override {
    return current().predict(preview, count, positions);
  }
  double stagePeriod() const noexcept override { return current().stagePeriod(); }
  double kktResidual() const noexcept override { return current().kktResidual(); }
  void reset() noexcept override;
  const ControlReport& report() const noexcept override { return current().report(); }

 private:
  ControlLaw& current() const noexcept { return *laws_[static_cast<std::size_t>(active_)]; }
  void syncInactive() noexcept;

  std::array<std::unique_ptr<ControlLaw>, kLawCount> laws_;
  Law active_;
  int preview_length_ = 1;
  double preview_period_ = 0.0;

  // True when the inactive laws have not tracked the last step yet.
  bool inactive_behind_ = false;
  // Vehicle state of the last step.
  VehicleState last_state_;
  // Command of the last step.
  AttitudeCommand sent_;
};

}  // namespace polyfly
