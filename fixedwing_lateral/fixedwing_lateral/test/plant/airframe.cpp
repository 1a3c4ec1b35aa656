#include "fixedwing_plant/airframe.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "fixedwing_lateral/model.hpp"

namespace polyfly {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kLeastAirspeed = 0.5;  // below it the air does nothing [m/s]

struct BodyRate {
  Vector3d position, velocity, rates;
  // Rates of the quaternion's coefficients (x, y, z, w).
  Eigen::Vector4d attitude;
};

BodyRate rateOf(const Airframe& airframe, const BodyState& state, const Controls& controls,
                const AirMotion& air) {
  const Vector3d flow_rates = state.rates - Vector3d(air.roll_gust, 0.0, 0.0);
  const Wrench wrench = wrenchOf(airframe, airVelocity(state, air), flow_rates, controls);
  const Matrix3d inertia = airframe.inertiaTensor();
  BodyRate rate;
  rate.position = state.attitude * state.velocity;
  rate.velocity = wrench.force / airframe.mass + state.attitude.conjugate() * Vector3d(0.0, 0.0, kGravity) -
                  state.rates.cross(state.velocity);
  rate.rates = inertia.inverse() * (wrench.moment - state.rates.cross(inertia * state.rates));
  const Quaterniond spin(0.0, state.rates.x(), state.rates.y(), state.rates.z());
  rate.attitude = 0.5 * (state.attitude * spin).coeffs();
  return rate;
}

BodyState moved(const BodyState& state, const BodyRate& rate, double duration) {
  BodyState next;
  next.position = state.position + duration * rate.position;
  next.velocity = state.velocity + duration * rate.velocity;
  next.attitude.coeffs() = state.attitude.coeffs() + duration * rate.attitude;
  next.attitude.normalize();
  next.rates = state.rates + duration * rate.rates;
  return next;
}

BodyState levelFlight(double airspeed, double alpha) {
  BodyState state;
  state.velocity = airspeed * Vector3d(std::cos(alpha), 0.0, std::sin(alpha));
  state.attitude = attitudeOf(0.0, alpha, 0.0);
  return state;
}

/// Forward, downward and pitch acceleration at (alpha, throttle, elevator).
Vector3d imbalance(const Airframe& airframe, double airspeed, const Vector3d& unknowns) {
  Controls controls;
  controls.throttle = unknowns[1];
  controls.elevator = unknowns[2];
  const BodyRate rate = rateOf(airframe, levelFlight(airspeed, unknowns[0]), controls, {});
  return {rate.velocity.x(), rate.velocity.z(), rate.rates.y()};
}

}  // namespace

Matrix3d Airframe::inertiaTensor() const {
  Matrix3d tensor = inertia.asDiagonal();
  tensor(0, 2) = tensor(2, 0) = -inertia_xz;
  return tensor;
}

Vector3d airVelocity(const BodyState& state, const AirMotion& air) {
  return state.velocity - state.attitude.conjugate() * air.wind - air.gust;
}

Wrench wrenchOf(const Airframe& f, const Vector3d& air_velocity, const Vector3d& rates,
                const Controls& controls) {
  Wrench wrench;
  wrench.force.x() = f.thrust_max * std::clamp(controls.throttle, 0.0, 1.0);
  const double V = air_velocity.norm();
  if (V < kLeastAirspeed) return wrench;
  const double alpha = std::clamp(std::atan2(air_velocity.z(), air_velocity.x()), -f.alpha_max, f.alpha_max);
  const double beta = std::asin(std::clamp(air_velocity.y() / V, -1.0, 1.0));
  const double aileron = std::clamp(controls.aileron, -2.0 * f.deflection_max, 2.0 * f.deflection_max);
  const double elevator = std::clamp(controls.elevator, -f.deflection_max, f.deflection_max);
  const double rudder = std::clamp(controls.rudder, -f.deflection_max, f.deflection_max);
  const double pressure = 0.5 * f.density * V * V * f.area;
  const double p = rates.x() * f.span / (2.0 * V);
  const double q = rates.y() * f.chord / (2.0 * V);
  const double r = rates.z() * f.span / (2.0 * V);

  const double lift = f.l0 + alpha * (f.l1 + alpha * (f.l2 + alpha * f.l3));
  const double drag = f.d0 + alpha * (f.d1 + alpha * f.d2) + f.d_beta * beta * beta;
  // From the axes of the flow to those of the body.
  const double ca = std::cos(alpha), sa = std::sin(alpha), cb = std::cos(beta), sb = std::sin(beta);
  Matrix3d to_body;
  to_body << ca * cb, -ca * sb, -sa, sb, cb, 0.0, sa * cb, -sa * sb, ca;
  wrench.force += pressure * (to_body * Vector3d(-drag, f.y_beta * beta, -lift));
  wrench.moment =
      pressure *
      (to_body *
       Vector3d(f.span * (f.roll_beta * beta + f.roll_p * p + f.roll_r * r + f.roll_aileron * aileron),
                f.chord * (f.pitch_0 + f.pitch_alpha * alpha + f.pitch_q * q + f.pitch_elevator * elevator),
                f.span * (f.yaw_beta * beta + f.yaw_r * r + f.yaw_rudder * rudder)));
  return wrench;
}

BodyState advance(const Airframe& airframe, const BodyState& state, const Controls& controls,
                  const AirMotion& air, double duration) {
  const BodyRate k1 = rateOf(airframe, state, controls, air);
  const BodyRate k2 = rateOf(airframe, moved(state, k1, 0.5 * duration), controls, air);
  const BodyRate k3 = rateOf(airframe, moved(state, k2, 0.5 * duration), controls, air);
  const BodyRate k4 = rateOf(airframe, moved(state, k3, duration), controls, air);
  BodyRate mean;
  mean.position = (k1.position + 2.0 * k2.position + 2.0 * k3.position + k4.position) / 6.0;
  mean.velocity = (k1.velocity + 2.0 * k2.velocity + 2.0 * k3.velocity + k4.velocity) / 6.0;
  mean.attitude = (k1.attitude + 2.0 * k2.attitude + 2.0 * k3.attitude + k4.attitude) / 6.0;
  mean.rates = (k1.rates + 2.0 * k2.rates + 2.0 * k3.rates + k4.rates) / 6.0;
  return moved(state, mean, duration);
}

Trim trimLevel(const Airframe& airframe, double airspeed) {
  constexpr int kSteps = 30;
  constexpr double kDifference = 1e-6;
  Vector3d unknowns(0.03, 0.5, 0.0);
  Vector3d left = imbalance(airframe, airspeed, unknowns);
  for (int i = 0; i < kSteps && left.cwiseAbs().maxCoeff() > 1e-12; ++i) {
    Matrix3d slope;
    for (int column = 0; column < 3; ++column) {
      Vector3d other = unknowns;
      other[column] += kDifference;
      slope.col(column) = (imbalance(airframe, airspeed, other) - left) / kDifference;
    }
    unknowns -= slope.inverse() * left;
    left = imbalance(airframe, airspeed, unknowns);
  }
  Trim trim;
  trim.alpha = unknowns[0];
  trim.controls.throttle = unknowns[1];
  trim.controls.elevator = unknowns[2];
  trim.residual = left.cwiseAbs().maxCoeff();
  return trim;
}

Vector3d eulerAngles(const Quaterniond& q) {
  return {std::atan2(2.0 * (q.w() * q.x() + q.y() * q.z()), 1.0 - 2.0 * (q.x() * q.x() + q.y() * q.y())),
          std::asin(std::clamp(2.0 * (q.w() * q.y() - q.z() * q.x()), -1.0, 1.0)),
          std::atan2(2.0 * (q.w() * q.z() + q.x() * q.y()), 1.0 - 2.0 * (q.y() * q.y() + q.z() * q.z()))};
}

Quaterniond attitudeOf(double roll, double pitch, double yaw) {
  return Quaterniond(Eigen::AngleAxisd(yaw, Vector3d::UnitZ()) * Eigen::AngleAxisd(pitch, Vector3d::UnitY()) *
                     Eigen::AngleAxisd(roll, Vector3d::UnitX()));
}

}  // namespace polyfly
