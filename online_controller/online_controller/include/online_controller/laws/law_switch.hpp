#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "online_controller/estimation/delay_predictor.hpp"
#include "online_controller/laws/control_law.hpp"
#include "online_controller/laws/failsafe_policy.hpp"

namespace polyfly {

/// A law by its place in lawTypes(); lawOfName() finds it.
enum class Law : std::uint8_t {};

/// The laws of a flight, and what is sent where the active one has no answer (FailsafePolicy).
///
/// One of the laws is active, the others track what is sent. So a switch in flight has no step in the command. The
/// next law's observer is up to date, and its last command is the one that was sent.
///
/// The dead time is vehicle/delay, or else that of the first law's model, or else of another's. With one, all laws
/// are given the state that the vehicle will have when the command acts, see DelayPredictor. They are to be given
/// references from lead() on.
///
/// None of the functions after construction throws, allocates, locks, logs or reads a clock.
class LawSwitch {
 public:
  /// Laws in the order of lawTypes(), nullptr where there is none; `first` flies first. Throws Error when it is not there,
  /// or an option is out of range.
  LawSwitch(std::vector<std::unique_ptr<ControlLaw>> laws, Law first, const MultirotorOptions& options);

  /// One law alone, as Law{}.
  LawSwitch(std::unique_ptr<ControlLaw> law, const MultirotorOptions& options);

  bool has(Law law) const noexcept {
    const auto place = static_cast<std::size_t>(law);
    return place < laws_.size() && laws_[place] != nullptr;
  }
  Law active() const noexcept { return active_; }

  /// From the next step on. False, and nothing changes, when there is no such law.
  bool select(Law law) noexcept;

  /// The longest preview that one of the laws reads; all of them read the same.
  int previewLength() const noexcept { return preview_length_; }
  double previewPeriod() const noexcept { return preview_period_; }  ///< [s]
  /// Time of the first reference of a preview after the sample: the dead time [s].
  double lead() const noexcept { return predictor_.delay(); }
  /// How many of them the next step() reads.
  int previewNeeded() const noexcept { return current().previewLength(); }
  /// Time between the positions of inspect(), the first lead() after the sample [s].
  double stagePeriod() const noexcept { return current().timing().stage_period; }

  /// One control period, with the sample as it was measured.
  const ControlReport& step(const VehicleState& state, const Reference* preview) noexcept;

  /// What can be done for the next step without its sample. The inactive laws track here, after the command was sent;
  /// without this call, before the next other call.
  void prepare() noexcept {
    syncInactive();
    current().prepare();
  }

  /// While there is nothing to track, level attitude and hover thrust (kNoReference). `stamp` is the odometry's.
  const ControlReport& stepWithoutReference(double stamp) noexcept;

  /// In place of step() when the sample cannot be used: the next level of the FailsafePolicy.
  const ControlReport& withoutSample(double stamp, ControlReason reason) noexcept;

  /// When odometry is silent at time `now` [s], once in each control period. The FailsafePolicy begins with level
  /// attitude, because the receiver has held the last command already. The reason is kStale. That the silence is long
  /// enough is for the caller to judge.
  const ControlReport& onSilence(double now) noexcept;

  /// Of all laws; see ControlLaw.
  void forget(LawMemory what) noexcept;
  void setDisturbance(const Eigen::Vector3d& disturbance) noexcept;

  /// In place of step() while something else flies, see ControlLaw::track.
  void track(const VehicleState& state, const AttitudeCommand& sent) noexcept;

  /// After step(), see ControlLaw::correct.
  void correct(const AttitudeCommand& sent) noexcept;

  /// Goes on where `from` is, see ControlLaw::transferState.
  void transferState(const LawSwitch& from) noexcept;

  /// Looks at the last step, see ControlLaw::inspect.
  void inspect(const Reference* preview, LawInsight& insight) const noexcept {
    current().inspect(preview, insight);
  }

  /// As after construction; the active law stays.
  void reset() noexcept { forget(LawMemory::kAll); }

  /// Report of the last call.
  const ControlReport& report() const noexcept { return current().report(); }

 private:
  ControlLaw& current() const noexcept { return *laws_[static_cast<std::size_t>(active_)]; }
  void syncInactive() noexcept;
  const ControlReport& sendFromAll(const Substitute& sent) noexcept;
  // Keeps what is sent for the predictor.
  const ControlReport& remembered(const ControlReport& report) noexcept {
    predictor_.sent(report.stamp, report.command);
    return report;
  }

  std::vector<std::unique_ptr<ControlLaw>> laws_;
  Law active_;
  MultirotorOptions options_;
  FailsafePolicy failsafe_;
  DelayPredictor predictor_;
  int preview_length_ = 1;
  double preview_period_ = 0.0;

  // True when the inactive laws have not tracked the last step yet.
  bool inactive_behind_ = false;
  // Vehicle state of the last step, lead() after its sample.
  VehicleState last_state_;
  // Command of the last step.
  AttitudeCommand sent_;
};

}  // namespace polyfly
