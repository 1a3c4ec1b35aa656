#pragma once

#include <array>

#include "mpc_core/mpc_problem.hpp"
#include "nonlinear_mpc/multirotor_model.hpp"
#include "polyfly_base/range.hpp"

namespace polyfly {

/// What may be changed of one axis' problem (Eq. 38) without another model.
struct AxisTuning {
  double position_weight = 0.0;  ///< [1/m^2]
  double velocity_weight = 0.0;  ///< [s^2/m^2]
  double angle_weight = 0.0;     ///< [1/rad^2]; not of the vertical
  double command_weight = 0.0;   ///< R [1/rad^2, s^4/m^2]
  double rate_weight = 0.0;      ///< R_delta, of the change in a period [1/rad^2, s^4/m^2]
  double command_min = 0.0;      ///< [rad, m/s^2; 0 hovers]
  double command_max = 0.0;      ///< [rad, m/s^2; 0 hovers]
};

/// Of the linear law: longitudinal, lateral, vertical. Explicit maps have theirs baked in.
using LinearTuning = std::array<AxisTuning, 3>;

/// The one list of the tuning: calls visit(key, field, unit, range).
template <class Tuning, class Visit>
void visitLinearTuning(Tuning& tuning, Visit&& visit) {
  const Range weight{0.0, 1e6, 10.0, 1.0}, positive{1e-6, 1e6};
  visit("linear/position_weight_x", tuning[0].position_weight, "1/m^2", weight);
  visit("linear/position_weight_y", tuning[1].position_weight, "1/m^2", weight);
  visit("linear/position_weight_z", tuning[2].position_weight, "1/m^2", weight);
  visit("linear/velocity_weight_x", tuning[0].velocity_weight, "s^2/m^2", weight);
  visit("linear/velocity_weight_y", tuning[1].velocity_weight, "s^2/m^2", weight);
  visit("linear/velocity_weight_z", tuning[2].velocity_weight, "s^2/m^2", weight);
  visit("linear/pitch_weight", tuning[0].angle_weight, "1/rad^2", weight);
  visit("linear/roll_weight", tuning[1].angle_weight, "1/rad^2", weight);
  visit("linear/pitch_command_weight", tuning[0].command_weight, "1/rad^2", positive);
  visit("linear/roll_command_weight", tuning[1].command_weight, "1/rad^2", positive);
  visit("linear/thrust_command_weight", tuning[2].command_weight, "s^4/m^2", positive);
  visit("linear/pitch_rate_weight", tuning[0].rate_weight, "1/rad^2", weight);
  visit("linear/roll_rate_weight", tuning[1].rate_weight, "1/rad^2", weight);
  visit("linear/thrust_rate_weight", tuning[2].rate_weight, "s^4/m^2", weight);
  visit("linear/pitch_command_min", tuning[0].command_min, "rad", Range{-1.0, 0.0, 2.5, 0.05});
  visit("linear/pitch_command_max", tuning[0].command_max, "rad", Range{0.0, 1.0, 2.5, 0.05});
  visit("linear/roll_command_min", tuning[1].command_min, "rad", Range{-1.0, 0.0, 2.5, 0.05});
  visit("linear/roll_command_max", tuning[1].command_max, "rad", Range{0.0, 1.0, 2.5, 0.05});
  visit("linear/thrust_command_min", tuning[2].command_min, "m/s^2", Range{-30.0, 0.0, 2.0, 0.5});
  visit("linear/thrust_command_max", tuning[2].command_max, "m/s^2", Range{0.0, 200.0, 2.0, 0.5});
}

/// The tuning that is in the problems (longitudinal, lateral, vertical), bound by the names of their
/// parameters. Throws Error when an error of an axis is missing.
LinearTuning linearTuning(const std::array<MpcProblem, 3>& problems);

/// The problems with another tuning. Their text stays that of the file they came from.
std::array<MpcProblem, 3> tuned(std::array<MpcProblem, 3> problems, const LinearTuning& tuning);

/// The problems of Eq. 38 where there are no files: the model along the world's axes at yaw 0 (Eq. 39), a
/// sampling time [s], a horizon, and the weights and limits of a Firefly.
std::array<MpcProblem, 3> linearProblems(const MultirotorModel& model, double sampling_time, int horizon);

}  // namespace polyfly
