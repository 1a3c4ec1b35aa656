#pragma once

#include "online_controller/laws/swing_watch.hpp"
#include "online_controller/types/types.hpp"
#include "online_controller/types/vehicle_model.hpp"

namespace polyfly {

/// What a law reads and predicts, fixed when it is made.
struct LawTiming {
  /// Number of references that step() reads: the first at the state's time, each next one preview_period later.
  int preview_length = 1;
  double preview_period = 0.0;  ///< [s]
  /// Time between the positions of inspect() [s].
  double stage_period = 0.0;
};

/// What a law can be told to forget.
enum class LawMemory {
  /// Everything: as after construction.
  kAll,
  /// The plan, and that the last command was its own. report().command is what is sent instead.
  kPlan,
  /// Where the vehicle was: the next sample goes on from where it is. What is known of the disturbance is kept.
  kObserver,
  /// Gain and lag of the attitude loops that were found: with another dead time they are others.
  kLoops,
  /// The integral of the position error, see PositionIntegrator.
  kIntegral,
};

/// What a law tells those who watch.
struct LawInsight {
  /// Greatest violation of the KKT conditions by the last answer, relative to the gradient of its quadratic program.
  /// Negative where nothing was solved online.
  double kkt_residual = -1.0;

  /// Room for that many predicted positions [m]: at the last sample, and at each stage_period after it.
  int room = 0;
  Eigen::Vector3d* positions = nullptr;
  /// Number of positions that were filled in; 0 after a step without an answer.
  int count = 0;
};

/// A command that is sent in place of a law's answer.
struct Substitute {
  double stamp = 0.0;  ///< [s]
  ControlStatus status = ControlStatus::kHoldLast;
  ControlReason reason = ControlReason::kNone;
  AttitudeCommand command;
  /// True when the law had the sample and did not answer it.
  bool sampled = false;
};

/// One control law of a multirotor: it answers a sample or does not. What is sent without an answer is for the caller,
/// see LawSwitch.
///
/// In every control period step() is called, and prepare() when its command is out. None of the functions throws,
/// allocates, locks, logs or reads a clock. A law fills `report_`.
class ControlLaw {
 public:
  explicit ControlLaw(const LawTiming& timing, const VehicleModel& model = {})
      : timing_(timing), model_(model) {}
  virtual ~ControlLaw() = default;

  /// One control period. State and references are those of the time from which the command acts. Without an answer the
  /// report has kHoldLast and the reason, and the command of the last period. Bad numbers must not reach the law's memory.
  virtual const ControlReport& step(const VehicleState& state, const Reference* preview) noexcept = 0;

  /// What can be done for the next step without its sample.
  virtual void prepare() noexcept {}

  /// In place of step() while another law flies. Updates the observer and takes `sent` for its own last command, so
  /// that the next step() goes on from there.
  virtual void track(const VehicleState& state, const AttitudeCommand& sent) noexcept = 0;

  /// After step(): `sent` went out in place of the answer to `state`, and is the last command now.
  virtual void correct(const VehicleState& state, const AttitudeCommand& sent) noexcept {
    static_cast<void>(state);
    report_.command = sent;
  }

  virtual void forget(LawMemory what) noexcept = 0;

  /// What the observer begins with: a disturbance that is known from elsewhere [m/s^2].
  virtual void setDisturbance(const Eigen::Vector3d& disturbance) noexcept = 0;

  /// Goes on where `from` is, a law of the same kind made from other options or maps. Takes its observer, last
  /// command (within the limits of this one), and solution. For the time after step() and before prepare(). A law of
  /// another kind is ignored.
  virtual void transferState(const ControlLaw& from) noexcept = 0;

  /// Looks at the last step, between step() and prepare(). `preview` holds the references at the times of the
  /// positions, as far as there is room. Costs some microseconds: not for the way from odometry to command.
  virtual void inspect(const Reference* preview, LawInsight& insight) const noexcept = 0;

  /// What LawSwitch predicts with over a dead time.
  const VehicleModel& model() const noexcept { return model_; }
  const LawTiming& timing() const noexcept { return timing_; }
  int previewLength() const noexcept { return timing_.preview_length; }
  double previewPeriod() const noexcept { return timing_.preview_period; }  ///< [s]

  /// Report of the last call.
  const ControlReport& report() const noexcept { return report_; }

  /// Puts into the report what is sent in place of an answer. Unless the last command is held the plan is forgotten.
  void sendInstead(const Substitute& sent) noexcept;

 protected:
  /// Reports that this sample has no answer.
  const ControlReport& withoutAnswer(ControlReason reason) noexcept {
    report_.status = ControlStatus::kHoldLast;
    report_.reason = reason;
    return report_;
  }

  /// Reports whether the commands swing, for an answer at the heading `yaw` [rad].
  void watchSwings(const Reference& reference, double yaw, double angle_max) noexcept;

  ControlReport report_;
  SwingWatch swings_;

 private:
  LawTiming timing_;
  VehicleModel model_;
};

}  // namespace polyfly
