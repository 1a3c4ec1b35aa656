#pragma once

#include "nonlinear_mpc/multirotor_model.hpp"

namespace polyfly {

/// An attitude loop of second order, angle'' = stiffness (gain command - angle) - damping angle'. Gain and mean lag,
/// damping / stiffness, stand in MultirotorModel.
struct AngleLoop {
  double stiffness = 0.0;  ///< [1/s^2]; 0: the loop is of first order
  double damping = 0.0;    ///< [1/s]
};

/// How the vehicle answers commands, as a law has it from its problems or options.
struct VehicleModel {
  MultirotorModel motion;
  AngleLoop roll, pitch;
  /// Dead time from an odometry to the effect of its command [s].
  double delay = 0.0;
};

}  // namespace polyfly
