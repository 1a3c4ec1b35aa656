#include "nonlinear_mpc/multirotor_model.hpp"

#include <cmath>

namespace polyfly {
namespace {

// Columns of derivatives: velocity (3), roll and pitch at the start (2), input (3).
constexpr int kDirections = 8;
constexpr int kRoll = 3;
constexpr int kRollCommand = 5;
constexpr int kThrust = 7;
using Derivatives = Eigen::Matrix<double, 3, kDirections>;

/// A first-order lag: value(t) = decay value(0) + drive command.
struct Lag {
  double decay = 1.0;
  double drive = 0.0;
  Lag(double gain, double time, double t) noexcept
      : decay(std::exp(-t / time)), drive(gain * (1.0 - decay)) {}
};

/// The attitude at one instant of a stage: the body's axes, and by roll and pitch.
struct Node {
  Eigen::Matrix3d R, R_roll, R_pitch;
  Lag roll_lag, pitch_lag;

  Node(const MultirotorModel& model, const StageConditions& stage, const MultirotorState& x,
       const MultirotorInput& u, double t) noexcept
      : roll_lag(model.roll_gain, model.roll_time, t), pitch_lag(model.pitch_gain, model.pitch_time, t) {
    const double roll = roll_lag.decay * x(6) + roll_lag.drive * u(0);
    const double pitch = pitch_lag.decay * x(7) + pitch_lag.drive * u(1);
    const double yaw = stage.yaw + t * stage.yaw_rate;
    const double sr = std::sin(roll), cr = std::cos(roll);
    const double sp = std::sin(pitch), cp = std::cos(pitch);
    const double sy = std::sin(yaw), cy = std::cos(yaw);
    R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr,  //
        sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,   //
        -sp, cp * sr, cp * cr;
    R_roll.col(0).setZero();
    R_roll.col(1) = R.col(2);
    R_roll.col(2) = -R.col(1);
    R_pitch << -cy * sp, cy * cp * sr, cy * cp * cr,  //
        -sy * sp, sy * cp * sr, sy * cp * cr,         //
        -cp, -sp * sr, -sp * cr;
  }
};

/// Acceleration at a node with the velocity v, and its derivatives; `dv` are those of v.
struct Acceleration {
  Eigen::Vector3d value;
  Derivatives by;

  Acceleration(const MultirotorModel& model, const StageConditions& stage, const Node& node, double thrust,
               const Eigen::Vector3d& v, const Derivatives& dv) noexcept {
    const Eigen::Vector3d in_body = node.R.transpose() * v;
    const Eigen::Vector3d dragged = model.drag.cwiseProduct(in_body);
    value = thrust * node.R.col(2) - node.R * dragged + stage.disturbance;
    value(2) -= model.gravity;
    const Eigen::Matrix3d along = node.R * model.drag.asDiagonal();
    by.noalias() = -(along * node.R.transpose()) * dv;
    const Eigen::Vector3d by_roll =
        thrust * node.R_roll.col(2) - node.R_roll * dragged - along * (node.R_roll.transpose() * v);
    const Eigen::Vector3d by_pitch =
        thrust * node.R_pitch.col(2) - node.R_pitch * dragged - along * (node.R_pitch.transpose() * v);
    by.col(kRoll) += node.roll_lag.decay * by_roll;
    by.col(kRoll + 1) += node.pitch_lag.decay * by_pitch;
    by.col(kRollCommand) += node.roll_lag.drive * by_roll;
    by.col(kRollCommand + 1) += node.pitch_lag.drive * by_pitch;
    by.col(kThrust) += node.R.col(2);
  }
};

}  // namespace

void integrateStage(const MultirotorModel& model, double period, const StageConditions& stage,
                    const MultirotorState& x, const MultirotorInput& u, StageStep& step) noexcept {
  const double h = period;
  const Eigen::Vector3d v = x.segment<3>(3);
  Derivatives dv = Derivatives::Zero();
  dv.leftCols<3>().setIdentity();
  const Node start(model, stage, x, u, 0.0);
  const Node middle(model, stage, x, u, 0.5 * h);
  const Node end(model, stage, x, u, h);
  const Acceleration k1(model, stage, start, u(2), v, dv);
  const Acceleration k2(model, stage, middle, u(2), v + 0.5 * h * k1.value, dv + 0.5 * h * k1.by);
  const Acceleration k3(model, stage, middle, u(2), v + 0.5 * h * k2.value, dv + 0.5 * h * k2.by);
  const Acceleration k4(model, stage, end, u(2), v + h * k3.value, dv + h * k3.by);

  step.next.segment<3>(0) = x.segment<3>(0) + h * v + h * h / 6.0 * (k1.value + k2.value + k3.value);
  step.next.segment<3>(3) = v + h / 6.0 * (k1.value + 2.0 * k2.value + 2.0 * k3.value + k4.value);
  step.next(6) = end.roll_lag.decay * x(6) + end.roll_lag.drive * u(0);
  step.next(7) = end.pitch_lag.decay * x(7) + end.pitch_lag.drive * u(1);

  const Derivatives by_p = h * dv + h * h / 6.0 * (k1.by + k2.by + k3.by);
  const Derivatives by_v = dv + h / 6.0 * (k1.by + 2.0 * k2.by + 2.0 * k3.by + k4.by);
  step.A.setZero();
  step.B.setZero();
  step.A.block<3, 3>(0, 0).setIdentity();
  step.A.block<3, 5>(0, 3) = by_p.leftCols<5>();
  step.A.block<3, 5>(3, 3) = by_v.leftCols<5>();
  step.A(6, 6) = end.roll_lag.decay;
  step.A(7, 7) = end.pitch_lag.decay;
  step.B.topRows<3>() = by_p.rightCols<3>();
  step.B.middleRows<3>(3) = by_v.rightCols<3>();
  step.B(6, 0) = end.roll_lag.drive;
  step.B(7, 1) = end.pitch_lag.drive;
}

}  // namespace polyfly
