// How a control law is added: all of it stands in this file, and it flies beside the others.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/flight/flight_supervisor.hpp"
#include "online_controller/laws/failsafe_policy.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/types/attitude.hpp"
#include "online_controller/types/valid.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_test/law_flight.hpp"
#include "shipped_problems.hpp"

namespace polyfly {
namespace {

/// A proportional and derivative law at yaw 0: the least that flies.
class DampedLaw final : public ControlLaw {
 public:
  explicit DampedLaw(const MultirotorOptions& options) : ControlLaw(LawTiming{}), options_(options) {
    forget(LawMemory::kAll);
  }

  const ControlReport& step(const VehicleState& state, const Reference* preview) noexcept override {
    report_.stamp = state.stamp;
    if (!isValid(state) || !isValid(*preview)) return withoutAnswer(ControlReason::kNotFinite);
    const double damping = 2.0 * std::sqrt(kStiffness);
    const Eigen::Vector3d wanted = preview->acceleration + kStiffness * (preview->position - state.position) +
                                   damping * (preview->velocity - state.velocity) - disturbance_;
    const double lift = std::clamp(options_.gravity + wanted.z(), options_.thrust_min, options_.thrust_max);
    const auto tilt = [&](double acceleration) {
      return std::clamp(acceleration / lift, -options_.angle_max, options_.angle_max);
    };
    report_.command.pitch = tilt(wanted.x());
    report_.command.roll = tilt(-wanted.y());
    report_.command.thrust = options_.mass * lift;
    report_.status = ControlStatus::kOptimal;
    report_.reason = ControlReason::kNone;
    return report_;
  }

  void track(const VehicleState&, const AttitudeCommand& sent) noexcept override { report_.command = sent; }

  void forget(LawMemory what) noexcept override {
    if (what != LawMemory::kAll) return;
    disturbance_.setZero();
    report_ = ControlReport{};
    report_.command = levelCommand(options_, {});
  }

  void setDisturbance(const Eigen::Vector3d& disturbance) noexcept override { disturbance_ = disturbance; }

  void transferState(const ControlLaw& from) noexcept override {
    const auto* other = dynamic_cast<const DampedLaw*>(&from);
    if (other == nullptr) return;
    disturbance_ = other->disturbance_;
    report_ = other->report_;
  }

  void inspect(const Reference*, LawInsight& insight) const noexcept override { insight.count = 0; }

 private:
  static constexpr double kStiffness = 2.0;  // [1/s^2]
  MultirotorOptions options_;
  Eigen::Vector3d disturbance_ = Eigen::Vector3d::Zero();
};

LawType dampedType() {
  LawType type;
  type.name = "damped";
  type.make = [](const LawParts& parts) -> std::unique_ptr<ControlLaw> {
    return std::make_unique<DampedLaw>(parts.controller);
  };
  return type;
}

/// The project's laws and the new one: what its line in law_registry.cpp would do.
std::vector<LawType> typesWithDamped() {
  std::vector<LawType> types = lawTypes();
  types.push_back(dampedType());
  return types;
}

LawInputs inputs() {
  LawInputs inputs;
  inputs.problems = shippedProblems();
  return inputs;
}

FigureOptions withoutYaw() {
  FigureOptions figure;
  figure.rate = 0.4;
  figure.yaw_turn = 0.0;
  return figure;
}

/// Greatest distance from the figure [m]. `on_sample` may change the laws and the odometry.
template <class OnSample>
double fly(LawSwitch& laws, const OnSample& on_sample) {
  const FlightFigure figure(withoutYaw());
  LawFlight flight(figure, PlantOptions{}, laws);
  double greatest = 0.0;
  for (int sample = 0; !flight.over(); ++sample) {
    flight.measure();
    on_sample(sample, flight.state());
    const AttitudeCommand command = laws.step(flight.state(), flight.preview()).command;
    laws.prepare();
    flight.advance(command);
    greatest = std::max(greatest, flight.error());
  }
  return greatest;
}

TEST(NewLaw, IsRegisteredByOneLineAndFlies) {
  const std::vector<LawType> types = typesWithDamped();
  const Law damped = static_cast<Law>(types.size() - 1);
  const std::unique_ptr<LawSwitch> laws = makeLaws(types, inputs(), damped);
  EXPECT_EQ(laws->active(), damped);
  EXPECT_LT(fly(*laws, [](int, VehicleState&) {}), 0.3);
  EXPECT_EQ(laws->report().status, ControlStatus::kOptimal);
}

TEST(NewLaw, IsSwitchedToAndFrom) {
  const std::vector<LawType> types = typesWithDamped();
  const Law damped = static_cast<Law>(types.size() - 1);
  const std::unique_ptr<LawSwitch> laws = makeLaws(types, inputs(), lawOfName("linear"));
  std::set<Law> flown;
  const double greatest = fly(*laws, [&](int sample, VehicleState&) {
    if (sample % 300 == 299) laws->select(laws->active() == damped ? lawOfName("nonlinear") : damped);
    flown.insert(laws->active());
  });
  EXPECT_EQ(flown.size(), 3U);
  EXPECT_LT(greatest, 0.3);
}

// The law says no more than that it has no answer.
TEST(NewLaw, HasTheFallbackOfAllLaws) {
  const std::vector<LawType> types = typesWithDamped();
  const std::unique_ptr<LawSwitch> laws = makeLaws(types, inputs(), static_cast<Law>(types.size() - 1));
  const MultirotorOptions options;
  const int level = options.hold_periods + options.level_periods;
  const int descend = level + options.descend_periods;
  VehicleState state;
  Reference reference;
  reference.position = {0.5, 0.5, 0.5};
  const AttitudeCommand last = laws->step(state, &reference).command;
  EXPECT_NE(last.pitch, 0.0);
  state.velocity.x() = std::nan("");
  for (int k = 1; k <= descend + 3; ++k) {
    const ControlReport& report = laws->step(state, &reference);
    const ControlStatus expected = k <= options.hold_periods ? ControlStatus::kHoldLast
                                   : k <= level              ? ControlStatus::kLevel
                                   : k <= descend            ? ControlStatus::kDescend
                                                             : ControlStatus::kStopped;
    ASSERT_EQ(report.status, expected) << k;
    EXPECT_EQ(report.reason, ControlReason::kNotFinite);
    EXPECT_EQ(report.command.pitch, expected == ControlStatus::kHoldLast ? last.pitch : 0.0);
  }
  state.velocity.x() = 0.0;
  EXPECT_EQ(laws->step(state, &reference).status, ControlStatus::kOptimal);
  EXPECT_EQ(laws->onSilence(1.0).status, ControlStatus::kLevel);
  EXPECT_EQ(laws->stepWithoutReference(2.0).status, ControlStatus::kNoReference);
}

TEST(NewLaw, IsMissedByNameWhereItCannotBeMade) {
  const std::vector<LawType>& types = lawTypes();
  try {
    makeLaws(types, inputs(), lawOfName("explicit_linear"));
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), "law: explicit_linear is not there to fly with");
  }
}

}  // namespace
}  // namespace polyfly
