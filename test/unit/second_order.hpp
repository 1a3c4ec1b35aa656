#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/types/attitude.hpp"
#include "online_controller/types/types.hpp"
#include "polyfly_base/read_text.hpp"
#include "project_root.hpp"

namespace polyfly {

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

/// phi'' = 144 (0.9 phi_cmd - phi) - 19.2 phi', in each of both axes, as in reference/robust_lateral_4.yaml; the rest of
/// Eq. 37 as it stands.
class SecondOrderPlant {
 public:
  struct State {
    Eigen::Vector3d position = Eigen::Vector3d::Zero(), velocity = Eigen::Vector3d::Zero();
    TiltAngles tilt, rate;
  };

  /// `mass` [kg], `wind` [m/s^2] in W.
  SecondOrderPlant(const State& state, double yaw, const Eigen::Vector3d& wind, double mass)
      : state_(state), yaw_(yaw), wind_(wind), mass_(mass) {}

  VehicleState measure() const {
    VehicleState measured;
    measured.stamp = time_;
    measured.position = state_.position;
    measured.velocity = state_.velocity;
    measured.attitude = Eigen::AngleAxisd(yaw_, Eigen::Vector3d::UnitZ()) *
                        Eigen::AngleAxisd(state_.tilt.pitch, Eigen::Vector3d::UnitY()) *
                        Eigen::AngleAxisd(state_.tilt.roll, Eigen::Vector3d::UnitX());
    // Body rates of these Euler angles, without a yaw rate.
    measured.angular_velocity = {state_.rate.roll, state_.rate.pitch * std::cos(state_.tilt.roll),
                                 -state_.rate.pitch * std::sin(state_.tilt.roll)};
    return measured;
  }

  /// Flies `period` seconds with the command.
  void advance(const AttitudeCommand& command, double period = 0.01) {
    constexpr double kStep = 1e-3;
    for (double passed = 0.0; passed < period - 0.5 * kStep; passed += kStep) {
      const Eigen::Vector3d up = measure().attitude * Eigen::Vector3d::UnitZ();
      const Eigen::Vector3d acceleration =
          command.thrust / mass_ * up - Eigen::Vector3d(0.0, 0.0, 9.8066) + wind_;
      state_.velocity += kStep * acceleration;
      state_.position += kStep * state_.velocity;
      turn(command.roll, state_.tilt.roll, state_.rate.roll, kStep);
      turn(command.pitch, state_.tilt.pitch, state_.rate.pitch, kStep);
    }
    time_ += period;
  }

  const State& state() const { return state_; }
  double time() const { return time_; }

 private:
  static void turn(double command, double& angle, double& rate, double step) {
    rate += step * (144.0 * (0.9 * command - angle) - 19.2 * rate);
    angle += step * rate;
  }

  State state_;
  double yaw_;
  Eigen::Vector3d wind_;
  double mass_;
  double time_ = 0.0;
};

/// The tracking problem of an axis with the attitude loop of second order; `moves`: a line that blocks them.
inline MpcProblem secondOrderTracking(const std::string& axis, const std::string& moves = "") {
  std::string text = readText(problemFile("multirotor_" + axis + ".yaml"));
  const bool lateral = axis == "lateral";
  const std::string angle = lateral ? "phi" : "theta", drive = lateral ? "-9.8066" : "9.8066";
  const std::size_t model = text.find("\nmodel:"), weights = text.find("\nsampling_time:");
  const std::string p = lateral ? "p_y" : "p_x", v = lateral ? "v_y" : "v_x";
  std::string stated =
      "\nmodel:\n  states: [{name: P, unit: m}, {name: V, unit: m/s}, {name: ANGLE, unit: rad}, "
      "{name: ANGLE_rate, unit: rad/s}]\n"
      "  inputs: [{name: ANGLE_cmd, unit: rad, range: [-0.4363323, 0.4363323]}]\n"
      "  disturbances: [{name: d, unit: m/s^2}]\n"
      "  A: [[0, 1, 0, 0], [0, -0.01, DRIVE, 0], [0, 0, 0, 1], [0, 0, -144, -19.2]]\n"
      "  B: [[0], [0], [0], [129.6]]\n  B_d: [[0], [1], [0], [0]]\n  C: [[1, 0, 0, 0]]\n";
  stated = replaced(replaced(replaced(replaced(stated, "ANGLE", angle), "DRIVE", drive), "P,", p + ","), "V,",
                    v + ",");
  text = text.substr(0, model) + stated + text.substr(weights);
  text = replaced(text, "20, 20]", "20, 20, 0.1]");
  text = replaced(text, "\nweights:", "\n" + moves + "\nweights:");
  text +=
      "  - {name: e_" + angle + "_rate, role: error, of: " + angle + "_rate, unit: rad/s, range: [-6, 6]}\n";
  return parseProblem(text, "second_order_" + axis);
}

}  // namespace polyfly
