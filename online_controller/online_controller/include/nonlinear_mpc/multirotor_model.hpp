#pragma once

#include <Eigen/Core>
#include <array>

namespace polyfly {

/// Constants of Eq. 37.
struct MultirotorModel {
  double gravity = 9.8066;                ///< [m/s^2]
  double roll_gain = 0.9;                 ///< K_phi [-]
  double roll_time = 0.25;                ///< tau_phi [s]
  double pitch_gain = 0.9;                ///< K_theta [-]
  double pitch_time = 0.255;              ///< tau_theta [s]
  Eigen::Vector3d drag{0.01, 0.01, 0.0};  ///< A, along the axes of the body [1/s]
};

/// State: position, velocity (in W), roll, pitch. Yaw is no state: nothing that is optimised moves it.
constexpr int kMultirotorStates = 8;
/// Input: commanded roll, commanded pitch [rad], thrust over mass [m/s^2].
constexpr int kMultirotorInputs = 3;

using MultirotorState = Eigen::Matrix<double, kMultirotorStates, 1>;
using MultirotorInput = Eigen::Matrix<double, kMultirotorInputs, 1>;

/// What is given over one stage.
struct StageConditions {
  double yaw = 0.0;                                       ///< at its beginning [rad]
  double yaw_rate = 0.0;                                  ///< [rad/s]
  Eigen::Vector3d disturbance = Eigen::Vector3d::Zero();  ///< d of Eq. 37, in W [m/s^2]
};

/// x_next = f(x, u) over one stage and its derivatives.
struct StageStep {
  MultirotorState next;
  Eigen::Matrix<double, kMultirotorStates, kMultirotorStates, Eigen::RowMajor> A;  ///< df/dx
  Eigen::Matrix<double, kMultirotorStates, kMultirotorInputs, Eigen::RowMajor> B;  ///< df/du
};

/// Integrates Eq. 37 over `period` seconds with the input held. Drag acts along the axes of the body,
/// -R A R' v. The attitude is integrated exactly, velocity and position by one step of the classical
/// Runge-Kutta method; the derivatives are those of these formulas.
void integrateStage(const MultirotorModel& model, double period, const StageConditions& stage,
                    const MultirotorState& x, const MultirotorInput& u, StageStep& step) noexcept;

}  // namespace polyfly
