// Gusts that end: what they taught must not keep a law from its path afterwards.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "compared_laws.hpp"
#include "polyfly_test/gaussian_source.hpp"
#include "rigid_bodies.hpp"

namespace polyfly {
namespace {

constexpr double kGustStart = 10.0, kGustEnd = 70.0;  // [s]

/// Air from kGustStart to kGustEnd; it rests before and after.
struct Air {
  double gust = 0.0;  ///< rms of its push over mass in each axis, fading in 1 s [m/s^2]
  double wind = 0.0;  ///< along x [m/s]
  double drag = 0.0;  ///< of the vehicle, times the square of the speed through the air [N s^2/m^2]
};

/// RMS of the position error [m].
struct Errors {
  double in_gusts, after;  ///< after: from 30 to 50 s after them
};

Errors errorsOn(const Path& path, const RigidBodyOptions& vehicle, bool nonlinear, bool adapt_model,
                const Air& air, std::uint64_t seed) {
  MultirotorOptions options;
  options.adapt_model = adapt_model;
  options.mass = vehicle.mass;
  std::shared_ptr<ControlLaw> law;
  if (nonlinear) {
    law = std::make_shared<NonlinearController>(options, NonlinearMpcOptions{});
  } else {
    law = std::make_shared<MultirotorController>(problemsWith(nullptr), options);
  }
  const Pilot pilot = pilotOf(law);
  RigidBodyPlant plant(vehicle, path(0.0).position);
  GaussianSource source(seed);
  Eigen::Vector3d gust = Eigen::Vector3d::Zero();
  const double kept = std::exp(-kPeriod), drawn = std::sqrt(1.0 - kept * kept) * air.gust;
  double gusts = 0.0, after = 0.0;
  int gust_samples = 0, after_samples = 0;
  while (plant.time() < kGustEnd + 50.0) {
    const bool gusty = plant.time() > kGustStart && plant.time() < kGustEnd;
    gust = gusty ? Eigen::Vector3d(kept * gust + drawn * source.next3()) : Eigen::Vector3d::Zero();
    const Eigen::Vector3d wind(gusty ? air.wind : 0.0, 0.0, 0.0);
    const Eigen::Vector3d through_air = plant.truth().velocity - wind;
    plant.setForce(vehicle.mass * gust - air.drag * through_air.norm() * through_air);
    plant.advance(pilot(plant.measure(), path), kPeriod);
    const double square = (plant.position() - path(plant.time()).position).squaredNorm();
    if (gusty) {
      gusts += square;
      ++gust_samples;
    } else if (plant.time() >= kGustEnd + 30.0) {
      after += square;
      ++after_samples;
    }
  }
  return {std::sqrt(gusts / gust_samples), std::sqrt(after / after_samples)};
}

/// On a circle of 5 m/s after gusts of `sigma` [m/s^2].
double errorAfterGusts(const RigidBodyOptions& vehicle, bool nonlinear, bool adapt_model, double sigma,
                       std::uint64_t seed) {
  return errorsOn(helix(8.0, 5.0, 0.0), vehicle, nonlinear, adapt_model, {sigma}, seed).after;
}

/// To and fro about a place with these amplitudes [m] and rates [rad/s]; 5 s from rest to them.
Path shuttle(const Eigen::Vector2d& amplitude, const Eigen::Vector2d& rate) {
  return [=](double time) {
    constexpr double kRamp = 5.0;
    const double x = std::min(time / kRamp, 1.0);
    const double s = kRamp * x * x * x * x * (2.5 - 3.0 * x + x * x) + std::max(0.0, time - kRamp);
    const double ds = x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
    const double dds = 30.0 * x * x * (1.0 - x) * (1.0 - x) / kRamp;
    const double ddds = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (kRamp * kRamp);
    Reference reference;
    reference.position.z() = 3.0;
    for (Eigen::Index i = 0; i < amplitude.size(); ++i) {
      const double w = rate(i), sine = std::sin(w * s), cosine = std::cos(w * s);
      reference.position(i) = amplitude(i) * sine;
      reference.velocity(i) = amplitude(i) * w * cosine * ds;
      reference.acceleration(i) = amplitude(i) * w * (cosine * dds - w * sine * ds * ds);
      reference.jerk(i) =
          amplitude(i) * w * (cosine * ddds - 3.0 * w * sine * ds * dds - w * w * cosine * ds * ds * ds);
    }
    return reference;
  };
}

TEST(AdaptationInGusts, AfterGustsTheCircleIsFlownAsBefore) {
  for (const bool nonlinear : {false, true}) {
    for (const RigidBodyOptions& vehicle : {RigidBodyOptions{}, racer()}) {
      const double without = errorAfterGusts(vehicle, nonlinear, false, 2.0, 1003);
      const double with = errorAfterGusts(vehicle, nonlinear, true, 2.0, 1003);
      EXPECT_LT(with, 0.02) << vehicle.mass << " " << nonlinear;
      EXPECT_LT(with, 0.2 * without) << vehicle.mass << " " << nonlinear;
    }
    EXPECT_LT(errorAfterGusts(heavy(), nonlinear, true, 2.0, 1003),
              errorAfterGusts(heavy(), nonlinear, false, 2.0, 1003))
        << nonlinear;
  }
}

// Gusts last longer than a period: they must teach little. At most 5 of 80 conditions of both laws may be worse than without;
// of the linear law's 40, which are quick, at most 3.
TEST(AdaptationInGusts, CostsLittleInTheGusts) {
  constexpr double kWorse = 1.05, kWorseAfter = 1.2;
  constexpr int kMostWorse = 3;
  RigidBodyOptions vehicle = heavy();
  vehicle.position_noise = 0.002;
  vehicle.velocity_noise = 0.01;
  vehicle.attitude_noise = 0.003;
  constexpr double kDrag = 0.12;
  const Air airs[] = {
      {0.0, 0.0, kDrag}, {0.0, 5.0, kDrag}, {0.5, 0.0, kDrag}, {1.0, 5.0, kDrag}, {1.5, 0.0, kDrag}};
  const Path paths[] = {helix(8.0, 5.0, 0.0), helix(4.0, 2.5, 0.0), shuttle({6.0, 3.0}, {0.4, 0.8}),
                        shuttle({8.0, 0.0}, {0.6, 0.0})};
  int worse = 0;
  for (const Path& path : paths) {
    for (const Air& air : airs) {
      for (const std::uint64_t seed : {1, 2}) {
        vehicle.seed = seed;
        const Errors without = errorsOn(path, vehicle, false, false, air, 1000 + seed);
        const Errors with = errorsOn(path, vehicle, false, true, air, 1000 + seed);
        worse += with.in_gusts > kWorse * without.in_gusts ? 1 : 0;
        EXPECT_LT(with.after, kWorseAfter * without.after) << air.gust << ", " << air.wind << ", " << seed;
      }
    }
  }
  EXPECT_LE(worse, kMostWorse);
}

}  // namespace
}  // namespace polyfly
