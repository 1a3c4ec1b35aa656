#pragma once

#include "polyfly_test/rigid_body_plant.hpp"

namespace polyfly {

/// Attitude loops with these two lags [s], where the shipped model has one of 0.25 s.
inline void setLoops(double slow, double fast, RigidBodyOptions* body) {
  body->stiffness = 1.0 / (slow * fast);
  body->damping = (slow + fast) / (slow * fast);
}

inline RigidBodyOptions racer() {
  RigidBodyOptions body;
  body.mass = 0.5;
  body.inertia = {0.002, 0.002, 0.0035};
  body.arm = 0.08;
  body.rotor_up = 0.01;
  body.rotor_down = 0.015;
  body.rotor_max = 5.0;
  body.drag = 0.2;
  body.moment_max = {0.5, 0.5, 0.1};
  setLoops(0.07, 0.03, &body);
  return body;
}

/// A hexacopter's weight, slow loops, slow rotors and a delay.
inline RigidBodyOptions heavy() {
  RigidBodyOptions body;
  body.mass = 8.0;
  body.inertia = {0.35, 0.35, 0.6};
  body.arm = 0.4;
  body.rotor_up = 0.06;
  body.rotor_down = 0.08;
  body.rotor_max = 45.0;
  body.drag = 0.02;
  body.moment_max = {8.0, 8.0, 2.0};
  body.command_delay = 0.03;
  setLoops(0.24, 0.18, &body);
  return body;
}

}  // namespace polyfly
