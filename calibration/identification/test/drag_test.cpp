// Drag along the axes and along the body of made motions.
#include <gtest/gtest.h>

#include <string>

#include "identification/motion.hpp"
#include "made_motion.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using test::kMass;
using test::MadeMotion;
using test::makeMotion;

TEST(Drag, FindsTheDragOfTheRotorsAlongTheBody) {
  int inside = 0;
  constexpr int kFlights = 20;
  for (std::uint32_t seed = 1; seed <= kFlights; ++seed) {
    MadeMotion made;
    made.gust = 0.03;
    made.drag_turns = true;
    const auto found = fitDrag({motionOf(makeMotion(made, seed), {})}).parameters;
    ASSERT_EQ(found.size(), 6u);
    for (const std::size_t axis : {0u, 1u}) {
      const FittedParameter& drag = found[4 + axis];
      EXPECT_EQ(drag.name, axis == 0 ? "drag_forward" : "drag_left");
      const double truth = made.drag[static_cast<Eigen::Index>(axis)];
      inside += drag.least() <= truth && truth <= drag.greatest() ? 1 : 0;
      EXPECT_NEAR(drag.value, truth, 0.02);
      EXPECT_TRUE(drag.supported);
    }
  }
  EXPECT_GE(inside, 2 * kFlights * 9 / 10);
}

// Without drag, about half of the estimates are negative, and none may be handed out.
TEST(Drag, ADragThatIsNotAboveZeroIsNotSupported) {
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    MadeMotion made;
    made.gust = 0.05;
    made.drag.setZero();
    const MotionFit fit = fitDrag({motionOf(makeMotion(made, seed), {})});
    for (const FittedParameter& one : fit.parameters) {
      const bool drag = one.name.rfind("drag", 0) == 0;
      EXPECT_TRUE(!drag || one.least() > 0.0 || !one.supported) << one.name;
    }
    EXPECT_FALSE(fit.warnings.empty());
  }
}

TEST(Drag, FindsDragWithinItsInterval) {
  int inside = 0;
  constexpr int kFlights = 20;
  for (std::uint32_t seed = 1; seed <= kFlights; ++seed) {
    MadeMotion made;
    made.gust = 0.03;  // calm air
    MotionOptions options;
    options.mass = kMass;
    const auto found = fitDrag({motionOf(makeMotion(made, seed), options)}).parameters;
    ASSERT_EQ(found.size(), 8u);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const FittedParameter& drag = found[2 * axis];
      const double truth = made.drag[static_cast<Eigen::Index>(axis)];
      inside += drag.least() <= truth && truth <= drag.greatest() ? 1 : 0;
      EXPECT_NEAR(drag.value, truth, 0.02);
    }
  }
  // At least 54 of 60 intervals hold the true value.
  EXPECT_GE(inside, 54);
}

TEST(Drag, FindsDragWithoutAKnownThrust) {
  MadeMotion made;
  made.drag.z() = 0.0;
  made.gust = 0.02;
  FlightSignals signals = makeMotion(made, 2);
  signals.series.erase("thrust_cmd");
  const auto found = fitDrag({motionOf(signals, {})}).parameters;
  ASSERT_EQ(found.size(), 6u);
  EXPECT_NEAR(found[0].value, made.drag.x(), 0.02);
  EXPECT_NEAR(found[2].value, made.drag.y(), 0.02);
  EXPECT_THROW(fitMass({motionOf(signals, {})}, {}), Error);
}

}  // namespace
}  // namespace polyfly
