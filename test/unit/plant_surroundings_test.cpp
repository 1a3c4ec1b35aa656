// What makes the plant harder: turbulence in a wind, a load on a string, an attitude controller that is not
// aligned.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "polyfly_base/error.hpp"
#include "polyfly_test/multirotor_plant.hpp"

namespace polyfly {
namespace {

using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

// Power of a sampled signal at a frequency, averaged over segments under a Hann window [unit^2 s], one-sided.
double powerDensity(const std::vector<double>& samples, double step, double frequency, std::size_t segment) {
  double sum = 0.0, weight = 0.0;
  int count = 0;
  for (std::size_t i = 0; i < segment; ++i) {
    const double window = 0.5 - 0.5 * std::cos(2.0 * kPi * static_cast<double>(i) / segment);
    weight += window * window;
  }
  for (std::size_t from = 0; from + segment <= samples.size(); from += segment / 2, ++count) {
    double real = 0.0, imaginary = 0.0;
    for (std::size_t i = 0; i < segment; ++i) {
      const double window = 0.5 - 0.5 * std::cos(2.0 * kPi * static_cast<double>(i) / segment);
      const double angle = 2.0 * kPi * frequency * step * static_cast<double>(i);
      real += window * samples[from + i] * std::cos(angle);
      imaginary += window * samples[from + i] * std::sin(angle);
    }
    sum += real * real + imaginary * imaginary;
  }
  return 2.0 * step * sum / (count * weight);
}

// The spectra of MIL-F-8785C, one-sided in Hz.
double alongDensity(double sigma, double time, double frequency) {
  const double omega = 2.0 * kPi * frequency;
  return 4.0 * sigma * sigma * time / (1.0 + time * time * omega * omega);
}
double acrossDensity(double sigma, double time, double frequency) {
  const double squared = std::pow(2.0 * kPi * frequency * time, 2);
  return 2.0 * sigma * sigma * time * (1.0 + 3.0 * squared) / std::pow(1.0 + squared, 2);
}

TEST(DrydenTurbulence, HasItsVarianceAndItsSpectrum) {
  const Vector3d mean(0.0, -4.0, 0.0), sigma(0.5, 0.3, 0.2);
  constexpr double kLength = 2.0, kStep = 0.02, kTime = kLength / 4.0;
  DrydenTurbulence air(mean, sigma, kLength, kStep, 7);
  std::vector<double> along, across, up;
  for (int i = 0; i < 200000; ++i) {
    // The wind blows along -y.
    along.push_back(-air.velocity().y());
    across.push_back(air.velocity().x());
    up.push_back(air.velocity().z());
    air.advance();
  }
  const auto deviation = [](const std::vector<double>& samples) {
    double sum = 0.0;
    for (const double sample : samples) sum += sample * sample;
    return std::sqrt(sum / static_cast<double>(samples.size()));
  };
  // 8000 correlation times: the estimate's own deviation is about 1 %.
  EXPECT_NEAR(deviation(along), 0.5, 0.02);
  EXPECT_NEAR(deviation(across), 0.3, 0.012);
  EXPECT_NEAR(deviation(up), 0.2, 0.008);
  for (const double frequency : {0.25, 0.5, 1.0, 2.0}) {
    const double density = alongDensity(0.5, kTime, frequency);
    EXPECT_NEAR(powerDensity(along, kStep, frequency, 1000), density, 0.15 * density) << frequency;
    const double side = acrossDensity(0.3, kTime, frequency);
    EXPECT_NEAR(powerDensity(across, kStep, frequency, 1000), side, 0.15 * side) << frequency;
  }
}

TEST(DrydenTurbulence, ItsVarianceDoesNotDependOnTheStepAndIsThereFromTheStart) {
  for (const double step : {0.001, 1.0}) {
    Vector3d sum = Vector3d::Zero();
    constexpr int kDraws = 4000;
    for (int seed = 0; seed < kDraws; ++seed) {
      DrydenTurbulence air({3.0, 0.0, 0.0}, {1.0, 1.0, 1.0}, 3.0, step, static_cast<std::uint64_t>(seed));
      if (step > 0.5) air.advance();
      sum += air.velocity().cwiseAbs2();
    }
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(sum[axis] / kDraws, 1.0, 0.1) << axis << " " << step;
  }
}

// A vehicle so heavy that the load does not move it.
PlantOptions anchored() {
  PlantOptions options;
  options.mass = 1000.0;
  options.drag.setZero();
  options.load.mass = 0.16;
  options.load.stiffness = 1e4;
  options.load.damping = 0.0;
  options.substep = 0.0005;
  return options;
}

AttitudeCommand hover(const PlantOptions& options, double carried) {
  AttitudeCommand command;
  command.thrust = carried * options.gravity;
  return command;
}

PlantState hovering(const PlantOptions& options) {
  PlantState state;
  state.thrust = options.gravity;
  return state;
}

TEST(SlungLoad, SwingsWithThePeriodOfAPendulum) {
  const PlantOptions options = anchored();
  const double length = options.load.hangingLength(options.gravity);
  constexpr double kAngle = 0.2;
  PlantState start = hovering(options);
  start.load_offset = length * Vector3d(std::sin(kAngle), 0.0, -std::cos(kAngle));
  MultirotorPlant plant(options, start);
  std::vector<double> crossings;
  double last = start.load_offset.x();
  for (int i = 1; i <= 2000; ++i) {
    plant.advance(hover(options, options.mass));
    const double now = plant.state().load_offset.x();
    if (last > 0.0 && now <= 0.0) crossings.push_back(0.01 * (i - now / (now - last)));
    last = now;
  }
  ASSERT_GT(crossings.size(), 8u);
  const double period = (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  // the pendulum's series in its amplitude; the string gives by a tenth of a millimetre
  const double small = 2.0 * kPi * std::sqrt(length / options.gravity);
  EXPECT_NEAR(period, small * (1.0 + kAngle * kAngle / 16.0 + 11.0 * std::pow(kAngle, 4) / 3072.0), 1e-3);
}

TEST(SlungLoad, BouncesWithThePeriodOfASpring) {
  PlantOptions options = anchored();
  options.load.stiffness = 60.0;
  PlantState start = hovering(options);
  start.load_offset = {0.0, 0.0, -options.load.hangingLength(options.gravity) - 0.01};
  MultirotorPlant plant(options, start);
  const double period = 2.0 * kPi * std::sqrt(options.load.mass / options.load.stiffness);
  for (int i = 1; i <= 200; ++i) {
    plant.advance(hover(options, options.mass));
    EXPECT_NEAR(plant.state().load_offset.z() + options.load.hangingLength(options.gravity),
                -0.01 * std::cos(2.0 * kPi * 0.01 * i / period), 1e-4);
  }
}

// Vehicle, load and string are a closed system but for gravity and the thrust: what they gain is what the
// thrust gives; through slack and taut alike.
TEST(SlungLoad, KeepsEnergyAndMomentum) {
  PlantOptions options;
  options.mass = 0.65;
  options.drag.setZero();
  options.thrust_min = 0.0;
  options.load.mass = 0.16;
  options.load.damping = 0.0;
  options.substep = 0.0005;
  PlantState start;
  start.velocity = {0.5, -0.2, 0.0};
  start.load_offset = {0.3, 0.1, -0.7};
  start.load_velocity = {-1.0, 0.5, 1.5};
  MultirotorPlant plant(options, start);
  const auto energy = [&] {
    const PlantState& s = plant.state();
    const double stretch = std::max(0.0, s.load_offset.norm() - options.load.length);
    return 0.5 * options.mass * s.velocity.squaredNorm() +
           0.5 * options.load.mass * s.load_velocity.squaredNorm() +
           0.5 * options.load.stiffness * stretch * stretch +
           options.gravity *
               (options.mass * s.position.z() + options.load.mass * (s.position.z() + s.load_offset.z()));
  };
  const auto momentum = [&] {
    const PlantState& s = plant.state();
    return Vector3d(options.mass * s.velocity + options.load.mass * s.load_velocity);
  };
  const double energy_before = energy();
  const Vector3d momentum_before = momentum();
  bool slack = false, taut = false;
  for (int i = 1; i <= 300; ++i) {
    plant.advance(AttitudeCommand{});
    (plant.state().load_offset.norm() > options.load.length ? taut : slack) = true;
    const Vector3d fallen(0.0, 0.0, -(options.mass + options.load.mass) * options.gravity * 0.01 * i);
    EXPECT_LT((momentum() - momentum_before - fallen).norm(), 1e-10);
    // a substep in which the string grows taut is no more smooth
    EXPECT_NEAR(energy(), energy_before, 1e-4);
  }
  EXPECT_TRUE(slack);
  EXPECT_TRUE(taut);
}

TEST(SlungLoad, HangsAtRestUntilItIsHit) {
  PlantOptions options;
  options.mass = 0.65;
  options.load.mass = 0.16;
  options.load_hit = {0.0, 1.6, 0.0};
  options.load_hit_start = 1.0;
  options.load_hit_time = 0.1;
  PlantState start = hovering(options);
  start.thrust = options.gravity * (options.mass + options.load.mass) / options.mass;
  MultirotorPlant plant(options, start);
  const double carried = options.mass + options.load.mass;
  for (int i = 0; i < 100; ++i) {
    plant.advance(hover(options, carried));
    ASSERT_LT(plant.state().velocity.norm(), 1e-9) << i;
    EXPECT_NEAR(plant.disturbance().z(), -options.load.mass * options.gravity / options.mass, 1e-9);
  }
  for (int i = 0; i < 10; ++i) plant.advance(hover(options, carried));
  // the hit's impulse is shared by both; a little went into drag
  const PlantState& state = plant.state();
  EXPECT_NEAR(options.mass * state.velocity.y() + options.load.mass * state.load_velocity.y(), 0.16, 1e-3);
  EXPECT_GT(plant.disturbance().y(), 0.0);
}

TEST(Wind, CarriesTheVehicleWithTheAir) {
  PlantOptions options;
  options.drag = {0.4, 0.4, 0.0};
  options.air_velocity = {0.0, 2.0, 0.0};
  MultirotorPlant plant(options, hovering(options));
  EXPECT_NEAR(plant.disturbance().y(), 0.8, 1e-12);
  for (int i = 0; i < 500; ++i) plant.advance(hover(options, options.mass));
  EXPECT_NEAR(plant.state().velocity.y(), 2.0 * (1.0 - std::exp(-0.4 * 5.0)), 1e-9);
}

TEST(Alignment, AnAttitudeControllerThatIsOffTiltsAtZeroCommand) {
  PlantOptions options;
  options.roll_offset = 0.03;
  options.pitch_offset = -0.02;
  MultirotorPlant plant(options, hovering(options));
  for (int i = 0; i < 600; ++i) plant.advance(hover(options, options.mass));
  EXPECT_NEAR(plant.state().roll, 0.03, 1e-9);
  EXPECT_NEAR(plant.state().pitch, -0.02, 1e-9);
}

TEST(Surroundings, TheSameSeedIsTheSameFlightAndBadOptionsAreRefused) {
  PlantOptions options;
  options.air_velocity = {1.0, 0.0, 0.0};
  options.turbulence_sigma = {0.3, 0.3, 0.3};
  options.load.mass = 0.1;
  const auto fly = [&] {
    MultirotorPlant plant(options, hovering(options));
    for (int i = 0; i < 100; ++i) plant.advance(hover(options, options.mass));
    return plant.state();
  };
  const PlantState first = fly(), again = fly();
  EXPECT_EQ(first.position, again.position);
  EXPECT_EQ(first.load_offset, again.load_offset);
  options.seed = 2;
  EXPECT_NE(first.position, fly().position);
  options.air_velocity.setZero();
  EXPECT_THROW(fly(), Error);
  options.turbulence_sigma.setZero();
  options.load.stiffness = 0.0;
  EXPECT_THROW(fly(), Error);
}

}  // namespace
}  // namespace polyfly
