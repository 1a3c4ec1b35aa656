// Objects handed over from the configuration thread to the control thread, and laws that go on where others were.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "online_controller/realtime/object_swap.hpp"
#include "online_support.hpp"

namespace polyfly {
namespace {

struct Counted {
  explicit Counted(int value) : number(value) { ++alive; }
  ~Counted() { --alive; }
  int number;
  int seen = 0;
  static std::atomic<int> alive;
};
std::atomic<int> Counted::alive{0};

TEST(ObjectSwap, TheNewestStagedObjectIsSwappedInAndTheOldOneComesBack) {
  {
    ObjectSwap<Counted> slot;
    auto current = std::make_unique<Counted>(0);
    const auto transfer = [](Counted& next, const Counted& old) { next.seen = old.number + 10; };
    EXPECT_FALSE(slot.swap(current, transfer));
    slot.stage(std::make_unique<Counted>(1));
    slot.stage(std::make_unique<Counted>(2));
    // The first staged object is gone.
    EXPECT_EQ(Counted::alive, 2);
    EXPECT_TRUE(slot.pending());
    EXPECT_TRUE(slot.swap(current, transfer));
    EXPECT_FALSE(slot.pending());
    EXPECT_EQ(current->number, 2);
    EXPECT_EQ(current->seen, 10);
    // The control thread frees nothing.
    EXPECT_EQ(Counted::alive, 2);
    slot.reclaim();
    EXPECT_EQ(Counted::alive, 1);
    slot.stage(std::make_unique<Counted>(3));
    EXPECT_TRUE(slot.swap(current, transfer));
    EXPECT_EQ(current->seen, 12);
  }
  EXPECT_EQ(Counted::alive, 0);
}

TEST(ObjectSwap, NothingIsSwappedBeforeTheLastOneWasReclaimed) {
  ObjectSwap<Counted> slot;
  auto current = std::make_unique<Counted>(0);
  const auto transfer = [](Counted&, const Counted&) {};
  slot.stage(std::make_unique<Counted>(1));
  ASSERT_TRUE(slot.swap(current, transfer));
  slot.stage(std::make_unique<Counted>(2));  // reclaims, too
  ASSERT_TRUE(slot.swap(current, transfer));
  EXPECT_EQ(current->number, 2);
}

TEST(ObjectSwap, TwoThreads) {
  {
    ObjectSwap<Counted> slot;
    std::atomic<bool> done{false};
    int taken = 0;
    int last = 0;
    std::thread control([&] {
      auto current = std::make_unique<Counted>(0);
      while (!done || slot.pending()) {
        if (slot.swap(current, [](Counted& next, const Counted& old) { next.seen = old.seen + 1; })) {
          ++taken;
          ASSERT_GT(current->number, last);
          ASSERT_EQ(current->seen, taken);
          last = current->number;
        }
        slot.pending();
      }
    });
    for (int i = 1; i <= 20000; ++i) slot.stage(std::make_unique<Counted>(i));
    done = true;
    while (slot.pending()) slot.reclaim();
    control.join();
    EXPECT_EQ(last, 20000);
    EXPECT_GT(taken, 0);
  }
  EXPECT_EQ(Counted::alive, 0);
}

// A vehicle that wanders about, and what it shall follow.
VehicleState wandering(int sample) {
  const double t = 0.01 * sample;
  VehicleState state;
  state.stamp = 3.0 + t;
  state.position = {0.3 * std::sin(t), 0.2 * std::cos(1.3 * t), 1.0 + 0.1 * std::sin(2.1 * t)};
  state.velocity = {0.3 * std::cos(t), -0.26 * std::sin(1.3 * t), 0.21 * std::cos(2.1 * t)};
  state.attitude = Eigen::AngleAxisd(0.3 * std::sin(0.4 * t), Eigen::Vector3d::UnitZ()) *
                   Eigen::AngleAxisd(0.05 * std::cos(3.0 * t), Eigen::Vector3d::UnitY());
  return state;
}

std::array<MpcProblem, 3> axisProblems() {
  std::array<MpcProblem, 3> problems;
  for (std::size_t i = 0; i < 3; ++i) problems[i] = parseProblem(polyfly_test::axisProblem(i), "problem");
  return problems;
}

MultirotorOptions withYawGain(double yaw_gain) {
  MultirotorOptions options;
  options.yaw_gain = yaw_gain;
  return options;
}

std::unique_ptr<ControlLaw> linearLaw(double yaw_gain) {
  return std::make_unique<MultirotorController>(axisProblems(), withYawGain(yaw_gain));
}

std::unique_ptr<ControlLaw> nonlinearLaw(double yaw_gain) {
  return std::make_unique<NonlinearController>(withYawGain(yaw_gain), NonlinearMpcOptions{});
}

std::unique_ptr<LawSwitch> switched(double yaw_gain, Law first) {
  std::vector<std::unique_ptr<ControlLaw>> laws(lawTypes().size());
  laws[static_cast<std::size_t>(lawOfName("linear"))] = linearLaw(yaw_gain);
  laws[static_cast<std::size_t>(lawOfName("nonlinear"))] = nonlinearLaw(yaw_gain);
  return std::make_unique<LawSwitch>(std::move(laws), first, withYawGain(yaw_gain));
}

double difference(const AttitudeCommand& a, const AttitudeCommand& b) {
  return std::max({std::abs(a.roll - b.roll), std::abs(a.pitch - b.pitch), std::abs(a.yaw_rate - b.yaw_rate),
                   std::abs(a.thrust - b.thrust)});
}

// A law of the same options that takes over in mid-flight answers as the old one would have.
template <class Make>
void expectSeamless(const Make& make) {
  const auto steady = make();
  auto current = make();
  std::vector<Reference> preview(static_cast<std::size_t>(steady->previewLength()));
  for (Reference& reference : preview) reference.position = {0.4, -0.2, 1.3};
  for (int sample = 0; sample < 300; ++sample) {
    const VehicleState state = wandering(sample);
    const AttitudeCommand expected = steady->step(state, preview.data()).command;
    const ControlReport& report = current->step(state, preview.data());
    ASSERT_EQ(report.status, ControlStatus::kOptimal);
    ASSERT_LT(difference(expected, report.command), 1e-8) << "sample " << sample;
    LawInsight insight;
    current->inspect(preview.data(), insight);
    EXPECT_LT(insight.kkt_residual, 1e-9);
    EXPECT_GE(insight.kkt_residual, 0.0);
    if (sample % 3 == 1) {
      auto next = make();
      next->transferState(*current);
      current = std::move(next);
    }
    steady->prepare();
    current->prepare();
  }
}

TEST(TakeOver, LinearGoesOn) {
  expectSeamless([] { return linearLaw(1.8); });
}
TEST(TakeOver, NonlinearGoesOn) {
  expectSeamless([] { return nonlinearLaw(1.8); });
}
TEST(TakeOver, TheSwitchGoesOn) {
  expectSeamless([] { return switched(1.8, lawOfName("nonlinear")); });
}

TEST(TakeOver, TheLawThatFliesStaysAndNewOptionsHold) {
  const std::unique_ptr<LawSwitch> old = switched(1.0, lawOfName("nonlinear"));
  old->select(lawOfName("linear"));
  const std::unique_ptr<LawSwitch> next = switched(2.0, lawOfName("nonlinear"));
  std::vector<Reference> preview(static_cast<std::size_t>(old->previewLength()));
  for (Reference& reference : preview) reference.yaw = 0.5;
  const double slow = old->step(wandering(0), preview.data()).command.yaw_rate;
  next->transferState(*old);
  EXPECT_EQ(next->active(), lawOfName("linear"));
  EXPECT_NEAR(next->step(wandering(0), preview.data()).command.yaw_rate, 2.0 * slow, 1e-9);
}

TEST(TakeOver, AHeldCommandMeetsTheNewLimits) {
  const std::unique_ptr<ControlLaw> old = linearLaw(1.8);
  std::vector<Reference> preview(static_cast<std::size_t>(old->previewLength()));
  for (Reference& reference : preview) reference.position = {20.0, 0.0, 1.5};
  const AttitudeCommand before = old->step(wandering(0), preview.data()).command;
  ASSERT_GT(before.pitch, 0.25);
  ASSERT_GT(before.thrust, 1.52 * 10.0);
  MultirotorOptions narrow;
  narrow.angle_max = 0.2;
  narrow.thrust_max = 10.0;
  MultirotorController next(axisProblems(), narrow);
  next.transferState(*old);
  VehicleState bad = wandering(1);
  bad.position.x() = std::nan("");
  const ControlReport& report = next.step(bad, preview.data());
  EXPECT_EQ(report.status, ControlStatus::kHoldLast);
  EXPECT_EQ(report.command.pitch, 0.2);
  EXPECT_LE(report.command.thrust, narrow.mass * narrow.thrust_max);
}

TEST(TakeOver, AnotherKindOfLawIsIgnored) {
  const std::unique_ptr<ControlLaw> linear = linearLaw(1.8);
  const std::unique_ptr<ControlLaw> nonlinear = nonlinearLaw(1.8);
  std::vector<Reference> preview(static_cast<std::size_t>(nonlinear->previewLength()));
  linear->step(wandering(0), preview.data());
  nonlinear->transferState(*linear);
  EXPECT_EQ(nonlinear->report().status, ControlStatus::kNoReference);
}

}  // namespace
}  // namespace polyfly
