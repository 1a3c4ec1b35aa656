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

/// RMS of the position error [m] on a circle from 30 to 50 s after gusts of `sigma` [m/s^2] in each axis.
double errorAfterGusts(const RigidBodyOptions& vehicle, bool nonlinear, bool adapt_model, double sigma,
                       std::uint64_t seed) {
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
  const Path path = helix(8.0, 5.0, 0.0);
  RigidBodyPlant plant(vehicle, path(0.0).position);
  GaussianSource source(seed);
  Eigen::Vector3d gust = Eigen::Vector3d::Zero();
  const double kept = std::exp(-kPeriod), drawn = std::sqrt(1.0 - kept * kept) * sigma;
  double sum = 0.0;
  int samples = 0;
  while (plant.time() < kGustEnd + 50.0) {
    const bool gusty = plant.time() > kGustStart && plant.time() < kGustEnd;
    gust = gusty ? Eigen::Vector3d(kept * gust + drawn * source.next3()) : Eigen::Vector3d::Zero();
    plant.setForce(vehicle.mass * gust);
    plant.advance(pilot(plant.measure(), path), kPeriod);
    if (plant.time() < kGustEnd + 30.0) continue;
    sum += (plant.position() - path(plant.time()).position).squaredNorm();
    ++samples;
  }
  return std::sqrt(sum / samples);
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

}  // namespace
}  // namespace polyfly
