// The flights of Figs. 10 to 13: references that are what they say, and what the robust MPC makes of them.
#include "polyfly_test/aslquad_figures.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <string>

#include "project_root.hpp"

namespace polyfly_test {
namespace {

const AslquadFlights& flights() {
  static const AslquadFlights kOnce(polyfly::problemFile("robust"), testing::TempDir() + "aslquad_figures_");
  return kOnce;
}

AslquadErrors flown(AslquadFigure figure, AslquadLaw law, int seed = 1) {
  return flights().judge(figure, flights().fly(figure, law, seed));
}

TEST(AslquadReferences, DerivativesAreThoseOfThePosition) {
  constexpr double kStep = 1e-4;
  for (const AslquadFigure figure : kAslquadFigures) {
    const double end = std::min(2.0 * kSquareLap, figureDuration(figure));
    for (double t = 0.0173; t < end - 0.01; t += 0.171) {
      const polyfly::Reference before = figureReference(figure, t - kStep);
      const polyfly::Reference now = figureReference(figure, t);
      const polyfly::Reference after = figureReference(figure, t + kStep);
      EXPECT_LT(((after.position - before.position) / (2.0 * kStep) - now.velocity).norm(), 1e-6) << t;
      EXPECT_LT(((after.velocity - before.velocity) / (2.0 * kStep) - now.acceleration).norm(), 1e-6) << t;
      EXPECT_LT(((after.acceleration - before.acceleration) / (2.0 * kStep) - now.jerk).norm(), 1e-5) << t;
      EXPECT_LT(std::max(std::abs(now.velocity.x()), std::abs(now.velocity.y())), 0.8) << t;
    }
  }
}

TEST(AslquadReferences, TheSquareIsFlownTenTimesAndEndsWhereItBegan) {
  int corners = 0;
  for (int lap = 0; lap < kSquareLaps; ++lap) {
    const double t = kSquareLap * (lap + 0.5) - 0.1;
    if ((figureReference(AslquadFigure::kSquare, t).position - Eigen::Vector3d(1, 1, 1)).norm() < 1e-12)
      ++corners;
  }
  EXPECT_EQ(corners, kSquareLaps);
  EXPECT_LT((figureReference(AslquadFigure::kSquare, 1e3).position - Eigen::Vector3d(0, 0, 1)).norm(), 1e-12);
}

TEST(AslquadFigures, HelixInTurbulentWind) {
  const AslquadErrors robust = flown(AslquadFigure::kHelix, AslquadLaw::kRobust);
  const AslquadErrors nominal = flown(AslquadFigure::kHelix, AslquadLaw::kNominal);
  EXPECT_LT(robust.rms, 0.05);
  EXPECT_LT(2.0 * robust.rms, nominal.rms);
  EXPECT_LT(robust.tilt, 0.36);
}

TEST(AslquadFigures, HoverWithAHitOnTheLoad) {
  const AslquadErrors robust = flown(AslquadFigure::kHit, AslquadLaw::kRobust);
  EXPECT_LT(robust.greatest, 0.06);
  EXPECT_LT(2.0 * robust.greatest, flown(AslquadFigure::kHit, AslquadLaw::kNominal).greatest);
}

TEST(AslquadFigures, SquareWithTheLoad) {
  const AslquadErrors robust = flown(AslquadFigure::kSquare, AslquadLaw::kRobust);
  EXPECT_LT(robust.greatest, 0.05);
  EXPECT_LT(robust.rms, flown(AslquadFigure::kSquare, AslquadLaw::kNominal).rms);
}

TEST(AslquadFigures, StepWithTheLoad) {
  const AslquadErrors robust = flown(AslquadFigure::kStep, AslquadLaw::kRobust);
  EXPECT_LT(robust.settled, 3.0);
  EXPECT_LT(robust.overshoot, 0.05);
  EXPECT_LT(robust.undershoot, 0.05);
  EXPECT_LT(robust.speed, 1.5);
}

TEST(AslquadFigures, TheSameSeedIsTheSameFlight) {
  const auto first = flights().fly(AslquadFigure::kHit, AslquadLaw::kRobust, 3);
  const auto again = flights().fly(AslquadFigure::kHit, AslquadLaw::kRobust, 3);
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i)
    ASSERT_EQ(first[i].truth.position, again[i].truth.position) << i;
}

}  // namespace
}  // namespace polyfly_test
