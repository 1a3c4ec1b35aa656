// How far options may be changed while commands are sent.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "nonlinear_mpc/nonlinear_mpc.hpp"
#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller/types/options.hpp"
#include "polyfly_base/change_bounds.hpp"
#include "polyfly_base/error.hpp"

namespace {

using polyfly::ChangeBounds;
using polyfly::Range;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kHuge = std::numeric_limits<double>::infinity();

/// A mass, and a trim that may be 0.
ChangeBounds massAndTrim() {
  return ChangeBounds(
      {{"mass", "kg", Range{0.01, 1000.0, 1.2}}, {"trim", "rad", Range{-0.2, 0.2, 1.0, 0.05}}}, {1.5, 0.0});
}

std::string refusal(const ChangeBounds& bounds, const std::vector<double>& wanted, double now) {
  try {
    bounds.check(wanted, now);
    return {};
  } catch (const polyfly::Error& error) {
    return error.what();
  }
}

TEST(ChangeBounds, RefuseWhatIsFarFromTheValueInForce) {
  const ChangeBounds bounds = massAndTrim();
  EXPECT_EQ(refusal(bounds, {1.5, 0.0}, 0.0), "");
  EXPECT_EQ(refusal(bounds, {1.8, 0.05}, 0.0), "");
  EXPECT_EQ(refusal(bounds, {1.25, -0.05}, 0.0), "");
  EXPECT_EQ(
      refusal(bounds, {1000.0, 0.0}, 0.0),
      "mass: while commands are sent it may go from 1.5 to at least 1.25 and at most 1.8 kg within 10 s, "
      "got 1000");
  for (const double mass : {1.81, 1.24, 0.01, -1.5, 0.0, kNan, kHuge, -kHuge})
    EXPECT_NE(refusal(bounds, {mass, 0.0}, 0.0), "") << mass;
  for (const double trim : {0.051, -0.051, kNan}) EXPECT_NE(refusal(bounds, {1.5, trim}, 0.0), "") << trim;
}

TEST(ChangeBounds, ManySmallChangesGoNoFurtherThanOne) {
  ChangeBounds bounds = massAndTrim();
  double now = 100.0;
  double mass = 1.5;
  int taken = 0;
  for (; taken < 100 && refusal(bounds, {1.05 * mass, 0.0}, now).empty(); ++taken, now += 0.5) {
    mass *= 1.05;
    bounds.change({mass, 0.0}, now);
  }
  EXPECT_EQ(taken, 3);
  EXPECT_NE(refusal(bounds, {1.5 / 1.21, 0.0}, now), "");
  EXPECT_EQ(refusal(bounds, {1.5, 0.0}, now), "");  // back is always open
  now += ChangeBounds::kRest;
  EXPECT_EQ(refusal(bounds, {1.2 * mass, 0.0}, now), "");
}

TEST(ChangeBounds, AChangeThatStayedLongEnoughIsWhereTheNextOneBegins) {
  ChangeBounds bounds = massAndTrim();
  bounds.change({1.8, 0.0}, 0.0);
  EXPECT_NE(refusal(bounds, {2.1, 0.0}, 9.9), "");
  EXPECT_EQ(refusal(bounds, {2.1, 0.0}, 10.1), "");
  EXPECT_EQ(refusal(bounds, {1.8, 0.05}, 1.0), "");  // each option for itself
}

TEST(ChangeBounds, OnTheGroundNothingCountsThatWasBefore) {
  ChangeBounds bounds = massAndTrim();
  bounds.change({1.8, 0.0}, 0.0);
  bounds.settle({500.0, 0.1});
  EXPECT_EQ(refusal(bounds, {590.0, 0.14}, 0.1), "");
  EXPECT_NE(refusal(bounds, {1.5, 0.1}, 0.1), "");
}

/// Every option must be able to move at all, and to leave 0 where it may be 0.
struct CanMove {
  void operator()(const char* key, double, const char*, const Range& range) const {
    EXPECT_TRUE(range.factor > 1.0 || range.step > 0.0) << key;
    EXPECT_GE(range.factor, 1.0) << key;
    EXPECT_TRUE(range.least > 0.0 || range.step > 0.0) << key;
  }
  void operator()(const char*, bool) const {}
};

TEST(ChangeBounds, EveryOptionCanMoveInFlight) {
  const polyfly::MultirotorOptions options;
  const polyfly::NonlinearMpcOptions nonlinear;
  const polyfly::LinearTuning linear{};
  polyfly::visitOptions(options, CanMove{});
  polyfly::visitNonlinearOptions(nonlinear, CanMove{});
  polyfly::visitLinearTuning(linear, CanMove{});
}

}  // namespace
