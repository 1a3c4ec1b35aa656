#pragma once

#include <vector>

#include "nonlinear_mpc/nonlinear_mpc.hpp"
#include "online_controller/estimation/force_observer.hpp"
#include "online_controller/laws/estimating_law.hpp"
#include "online_controller/types/options.hpp"

namespace polyfly {

/// Nonlinear MPC of a multirotor (Eq. 43): force observer, references made consistent with the model, one
/// real-time iteration in each step.
///
/// Yaw is predicted over the horizon with the rate that the yaw controller will command, and enters the model as a
/// function of time. The references of attitude, commands and lift follow position, velocity and acceleration of the
/// preview exactly, under the estimated disturbance. They exist because the model is flat. So nothing that is
/// weighted contradicts the path, and no offset is left.
///
/// Each answer is a finite command within the limits. A state far from the predicted one starts the iteration anew.
class NonlinearController : public EstimatingLaw {
 public:
  /// `mpc` without gravity and limits, which come from `options`. Throws Error naming an option.
  NonlinearController(const MultirotorOptions& options, const NonlinearMpcOptions& mpc);

  const ControlReport& step(const VehicleState& state, const Reference* preview) noexcept override;
  void prepare() noexcept override;
  void track(const VehicleState& state, const AttitudeCommand& sent) noexcept override;
  void setDisturbance(const Eigen::Vector3d& disturbance) noexcept override;
  void transferState(const ControlLaw& from) noexcept override;
  void inspect(const Reference* preview, LawInsight& insight) const noexcept override;

  const NonlinearMpc& mpc() const noexcept { return mpc_; }
  const ForceObserver& observer() const noexcept { return observer_; }

 private:
  int observe(const VehicleState& state, const EulerAngles& angles) noexcept;
  void predictYaw(double yaw, const Reference* preview) noexcept;
  Eigen::Vector3d disturbanceAt(const Reference& reference) const noexcept;
  StageReference onPath(const Reference& path, double yaw, const Eigen::Vector3d& disturbance) const noexcept;
  FollowedTilt undisturbedTilt(const Reference& now, const Reference& next) const noexcept;
  void lead(StageReference& from, const StageReference& to, const TiltAngles& decay) const noexcept;
  void makeReferences(const Reference* preview) noexcept;
  void matchStages() noexcept;
  TiltAngles added(const TiltAngles& tilt, double yaw_rate) const noexcept;
  bool answers(QpStatus status) const noexcept;
  bool solve(const MultirotorState& x, int periods) noexcept;
  bool isFar(const MultirotorState& x) const noexcept;
  void startIteration(const MultirotorState& x) noexcept;
  void send(const EulerAngles& angles, const Reference& reference) noexcept;
  void resetObservers() noexcept override;
  void forgetPlan() noexcept override;

  NonlinearMpc mpc_;
  ForceObserver observer_;

  // How far the model's tilt runs ahead in a stage, see matchStages [1].
  TiltAngles ahead_;
  // Disturbance of the last step, or of the step that is prepared [m/s^2].
  Eigen::Vector3d disturbance_ = Eigen::Vector3d::Zero();
  // Its rate then [m/s^3].
  Eigen::Vector3d disturbance_rate_ = Eigen::Vector3d::Zero();
  // Drag along the axes of W that the model leaves out [1/s].
  Eigen::Vector3d drag_ = Eigen::Vector3d::Zero();
  // What the next command follows.
  FollowedReference path_;
  // N + 1 stages; the last one has the yaw at the end.
  std::vector<StageConditions> stages_;
  std::vector<StageReference> references_;  // N + 1
  // Preview of the last step, for the preparation of the next.
  std::vector<Reference> preview_;
  // Difference from a stage's command to the command for one control period [rad].
  TiltAngles sooner_;
  // Yaw of the last sample [rad].
  double yaw_ = 0.0;
  // True when report_.command is the last one of this law, or of another.
  bool has_command_ = false;
  // True when there is a solution from which to continue.
  bool iterating_ = false;
  // True when the next sample is prepared.
  bool prepared_ = false;
  // Share of an angle that is left after a control period, and after a stage.
  TiltAngles period_decay_, stage_decay_;
};

}  // namespace polyfly
