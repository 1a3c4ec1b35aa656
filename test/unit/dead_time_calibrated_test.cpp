// Flights over a dead time with the model that `calibrate` finds of a rigid body.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "helix.hpp"
#include "online_controller/laws/law_switch.hpp"
#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "polyfly_test/rigid_body_plant.hpp"
#include "steps_to_identify.hpp"

namespace polyfly {
namespace {

constexpr double kPeriod = 0.01;  // [s]

/// Numbers of Eq. 37 for roll and pitch alike, as `calibrate` finds them.
struct Found {
  double gain, lag, delay, drag;
};

/// What is found in a minute of steps to and fro by a PI controller: with the delay in the lag, and apart.
std::pair<Found, Found> calibrated(double delay) {
  RigidBodyOptions options;
  options.command_delay = delay;
  options.velocity_noise = 0.01;
  options.attitude_noise = 0.002;
  const FlightSignals log = stepsToIdentify(options);
  const AxisModel roll = identifyAxis(axisRecords(log, "roll"), {});
  const double drag = parameterOf(fitDrag({motionOf(log, {})}).parameters, "drag_left").value;
  const auto found = [&](const char* name, bool apart) {
    const auto& parameters = roll.findModel(name)->fit.parameters;
    return Found{parameterOf(parameters, "gain").value, parameterOf(parameters, "tau").value,
                 apart ? parameterOf(parameters, "delay").value : 0.0, drag};
  };
  return {found("model_without_delay", false), found("model", true)};
}

/// Root mean square of the position error of a law with this model [m].
double flyRigidBody(const std::string& name, const Found& found, const Path& path, double delay,
                    const RigidBodyOptions& body = {}, const MultirotorOptions& options = {}) {
  std::unique_ptr<ControlLaw> law;
  NonlinearMpcOptions nonlinear;
  nonlinear.model.roll_gain = nonlinear.model.pitch_gain = found.gain;
  nonlinear.model.roll_time = nonlinear.model.pitch_time = found.lag;
  nonlinear.model.drag.head<2>().setConstant(found.drag);
  MultirotorOptions told = options;
  told.delay = found.delay;
  if (name == "nonlinear") {
    law = std::make_unique<NonlinearController>(told, nonlinear);
  } else {
    law = std::make_unique<MultirotorController>(linearProblems(nonlinear.model, 0.1, 20), told);
  }
  LawSwitch laws(std::move(law), told);
  RigidBodyOptions vehicle = body;
  vehicle.command_delay = delay;
  RigidBodyPlant plant(vehicle, path(0.0).position);
  std::vector<Reference> preview(static_cast<std::size_t>(laws.previewLength()));
  double sum = 0.0;
  constexpr int kSamples = 2000;
  for (int i = 0; i < kSamples; ++i) {
    const VehicleState state = plant.measure();
    for (std::size_t k = 0; k < preview.size(); ++k)
      preview[k] = path(state.stamp + laws.lead() + static_cast<double>(k) * laws.previewPeriod());
    const AttitudeCommand command = laws.step(state, preview.data()).command;
    laws.prepare();
    plant.advance(command, kPeriod);
    sum += (plant.position() - path(plant.time()).position).squaredNorm();
  }
  return std::sqrt(sum / kSamples);
}

/// Errors without delay, and with 60 ms: not known, counted as lag (what calibrations give where no delay is stated), and
/// told.
struct Costs {
  double undelayed, unknown, lag, told;
};

/// What `calibrate` finds without delay, and with 60 ms in the lag and apart.
struct Calibrations {
  Found none = calibrated(0.0).first;
  std::pair<Found, Found> delayed = calibrated(0.06);

  Costs fly(const std::string& law, const Path& path, const MultirotorOptions& options) const {
    return {flyRigidBody(law, none, path, 0.0, {}, options), flyRigidBody(law, none, path, 0.06, {}, options),
            flyRigidBody(law, delayed.first, path, 0.06, {}, options),
            flyRigidBody(law, delayed.second, path, 0.06, {}, options)};
  }
};

// A rigid body with rotor lag: what is found of it is not the whole of it.
TEST(DeadTimeFlights, ByWhatCalibrateFindsCostsAThirdToo) {
  const Calibrations calibrations;
  const auto& [lagging, apart] = calibrations.delayed;
  EXPECT_GT(apart.delay, 0.06);
  EXPECT_LT(apart.lag, lagging.lag - 0.06);
  MultirotorOptions constant, rate;
  constant.adapt_model = rate.adapt_model = false;
  rate.disturbance_rate_drift = 0.03;
  const std::pair<const char*, Path> paths[] = {{"circle", helix(8.0, 5.0, 0.0)},
                                                {"helix", helix(1.5, 1.5, 0.3)}};
  for (const auto& [name, path] : paths) {
    for (const std::string law : {"linear", "nonlinear"}) {
      const auto flown = [&, name = name, &path = path](const char* which, const MultirotorOptions& options) {
        const Costs costs = calibrations.fly(law, path, options);
        RecordProperty("rigid_" + law + "_" + name + which,
                       std::to_string(costs.undelayed) + " " + std::to_string(costs.unknown) + " " +
                           std::to_string(costs.lag) + " " + std::to_string(costs.told));
        return costs;
      };
      const auto third = [](const Costs& costs, double before) {
        return costs.undelayed + (before - costs.undelayed) / 3.0;
      };
      // The nonlinear law's circle has 0.46 of the cost of a delay that is not known.
      const Costs before = flown("_constant", constant);
      EXPECT_LT(before.told, third(before, before.lag)) << law << ", " << name;
      EXPECT_LT(before.told, before.unknown) << law << ", " << name;
      const Costs turning = flown("_rate", rate);
      EXPECT_LT(turning.told, third(turning, std::min(turning.lag, turning.unknown))) << law << ", " << name;
      const Costs now = flown("", {});
      const bool nonlinear = law == "nonlinear", nonlinear_circle = nonlinear && path(0.0).position.x() > 2.0;
      // Both numbers of this bar are those with adapt_model false.
      EXPECT_LT(now.told, third(before, std::min(before.lag, before.unknown))) << law << ", " << name;
      // A delay that is not told is found as lag. On the nonlinear law's circle that is as good as telling it.
      EXPECT_LT(now.told, (nonlinear_circle ? 1.15 : 0.6) * now.unknown) << law << ", " << name;
      // Counted as lag it is found twice, which makes the nonlinear law worse than adapt_model false does.
      EXPECT_LT(now.told, now.lag) << law << ", " << name;
      EXPECT_LT(now.lag, (nonlinear ? 2.7 : 1.1) * before.lag) << law << ", " << name;
    }
  }
}

// The laws' observers see predicted states, so that a delay that is not as told looks like a disturbance to them.
TEST(DeadTimeFlights, ByWhatCalibrateFindsHoversWhereTheDelayIsNotAsTold) {
  RigidBodyOptions noisy;
  noisy.position_noise = 0.005;
  noisy.velocity_noise = 0.02;
  noisy.attitude_noise = 0.005;
  const Path hover = [](double) { return Reference{}; };
  const Found none = calibrated(0.0).first;
  for (const double told : {0.06, 0.1}) {
    const Found apart = calibrated(told).second;
    for (const std::string law : {"linear", "nonlinear"}) {
      const double undelayed = flyRigidBody(law, none, hover, 0.0, noisy);
      for (const double delay : {told - 0.02, told, told + 0.02}) {
        const double rms = flyRigidBody(law, apart, hover, delay, noisy);
        RecordProperty("hover_rigid_" + law + "_" + std::to_string(std::lround(1000.0 * told)) + "_" +
                           std::to_string(std::lround(1000.0 * delay)),
                       std::to_string(undelayed) + " " + std::to_string(rms));
        EXPECT_LT(rms, (told > 0.06 ? 1.5 : 1.4) * undelayed) << law << ", " << told << ", " << delay;
      }
    }
  }
}

}  // namespace
}  // namespace polyfly
