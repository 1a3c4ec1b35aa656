// Missions: loiter at the end, gates, ends that were missed, short segments.
#include "fixedwing_lateral/mission.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

const SwitchCriterion kCriterion;
const Vector2d kNorthward(14.0, 0.0);

TEST(Mission, EndsInALoiterThatTheLastSegmentTouches) {
  for (const TurnDirection direction : {TurnDirection::kLeft, TurnDirection::kRight}) {
    const Mission mission = missionThrough({{0.0, 0.0}, {200.0, 0.0}}, {70.0, direction}, "test");
    ASSERT_EQ(mission.segments.size(), 2U);
    const auto& loiter = std::get<LoiterCircle>(mission.segments.back());
    EXPECT_EQ(loiter.direction, direction);
    const ClosestPoint nearest = closestPoint(loiter, {200.0, 0.0});
    EXPECT_LT((nearest.point.position - Vector2d(200.0, 0.0)).norm(), 1e-9);
    EXPECT_LT((nearest.point.tangent - Vector2d(1.0, 0.0)).norm(), 1e-9);
  }
  const Mission own = makeMission({LoiterCircle{{5.0, 5.0}, 40.0, TurnDirection::kLeft}}, {}, "test");
  EXPECT_EQ(own.segments.size(), 1U);
}

TEST(Mission, RefusesWhatCannotBeFlown) {
  EXPECT_THROW(makeMission({}, {}, "test"), Error);
  EXPECT_THROW(missionThrough({{1.0, 1.0}, {1.0, 1.0}}, {}, "test"), Error);
  EXPECT_THROW(missionThrough({{1.0, 1.0}, {2.0, std::nan("")}}, {}, "test"), Error);
  EXPECT_THROW(missionThrough({{1.0, 1.0}, {20.0, 1.0}}, {-5.0, TurnDirection::kLeft}, "test"), Error);
  const LoiterCircle circle{{0.0, 0.0}, 50.0, TurnDirection::kRight};
  try {
    makeMission({LineSegment{{0.0, 0.0}, {9.0, 0.0}}, circle, circle}, {}, "test");
    FAIL();
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("test: segment 1: a loiter has no end"), std::string::npos);
  }
  EXPECT_EQ(missionThrough({{0.0, 0.0}, {0.0, 0.0}, {9.0, 0.0}}, {}, "test").segments.size(), 2U);
  // Points that are one up to rounding have no direction between them that could be flown.
  const Mission merged =
      missionThrough({{0.0, 0.0}, {9.0, 0.0}, {9.0, 1e-9}, {9.0, 0.06}, {9.0, 0.12}, {9.0, 9.0}}, {}, "test");
  EXPECT_EQ(merged.segments.size(), 4U);
  EXPECT_EQ(merged.merged_points, 2);
}

TEST(MissionTrack, CutsCornersAndDoesNotCutSmoothJunctions) {
  MissionTrack corner(missionThrough({{0.0, 0.0}, {200.0, 0.0}, {200.0, 200.0}}, {}, "test"), kCriterion);
  EXPECT_FALSE(corner.advance({164.0, 0.0}, kNorthward));
  EXPECT_TRUE(corner.advance({166.0, 0.0}, kNorthward));
  EXPECT_EQ(corner.index(), 1);
  MissionTrack straight(missionThrough({{0.0, 0.0}, {200.0, 0.0}, {400.0, 0.0}}, {}, "test"), kCriterion);
  EXPECT_FALSE(straight.advance({189.0, 0.0}, kNorthward));
  EXPECT_TRUE(straight.advance({191.0, 0.0}, kNorthward));
}

TEST(MissionTrack, SwitchesCornersAtTheirBisectorWhereThatIsAskedFor) {
  SwitchCriterion criterion;
  criterion.at_bisector = true;
  MissionTrack track(
      missionThrough({{0.0, 0.0}, {200.0, 0.0}, {200.0, 200.0}, {0.0, 210.0}, {0.0, 410.0}}, {}, "test"),
      criterion);
  EXPECT_FALSE(track.advance({166.0, 0.0}, kNorthward));
  EXPECT_FALSE(track.advance({190.0, 9.0}, kNorthward));
  EXPECT_TRUE(track.advance({190.0, 11.0}, kNorthward));
  EXPECT_FALSE(track.advance({190.0, 150.0}, {0.0, 14.0}));
  track.shapeCorner({3.0, 0.0});  // up to 149 m from the corner
  EXPECT_TRUE(track.advance({80.0, 180.0}, {-10.0, 10.0}));
  EXPECT_EQ(track.index(), 2);
  // By the published condition, for a law that does not look ahead.
  EXPECT_FALSE(track.advance({30.0, 208.0}, {-14.0, 0.0}));
  EXPECT_TRUE(track.advance({30.0, 208.0}, {-14.0, 0.0}, true));
}

TEST(MissionTrack, HidesANextSegmentThatLeadsBackOrLiesElsewhere) {
  SwitchCriterion criterion;
  criterion.at_bisector = true;
  const LineSegment line{{0.0, 0.0}, {200.0, 0.0}};
  const auto isShown = [&](const PathSegment& next) {
    const MissionTrack track(makeMission({line, next}, {}, "test"), criterion);
    return &track.shownNext() == &track.next();
  };
  EXPECT_TRUE(isShown(LineSegment{{200.0, 0.0}, {200.0, 200.0}}));
  EXPECT_FALSE(isShown(LineSegment{{200.0, 0.0}, {0.0, 0.0}}));
  EXPECT_FALSE(isShown(LineSegment{{200.0, 90.0}, {400.0, 90.0}}));
  criterion.at_bisector = false;
  EXPECT_TRUE(isShown(LineSegment{{200.0, 0.0}, {0.0, 0.0}}));
}

TEST(MissionTrack, GoesOnWhereALineLiesBehind) {
  MissionTrack track(missionThrough({{0.0, 0.0}, {200.0, 0.0}, {200.0, 200.0}}, {}, "test"), kCriterion);
  EXPECT_FALSE(track.advance({190.0, 80.0}, kNorthward));  // far beside
  EXPECT_TRUE(track.advance({201.0, 80.0}, kNorthward));
  EXPECT_EQ(track.index(), 1);
  EXPECT_FALSE(track.advance({201.0, 80.0}, kNorthward));
}

TEST(MissionTrack, GoesOnWhereTheEndOfAnArcWasPassedBeside) {
  const ArcSegment arc{{0.0, 0.0}, 100.0, TurnDirection::kRight, 0.0, 4.0};
  MissionTrack track(makeMission({arc, LineSegment{{0.0, 0.0}, {500.0, 0.0}}}, {}, "test"), kCriterion);
  const auto at = [](double bearing) {
    return Vector2d(200.0 * std::cos(bearing), 200.0 * std::sin(bearing));
  };
  const auto along = [](double bearing) {
    return Vector2d(-14.0 * std::sin(bearing), 14.0 * std::cos(bearing));
  };
  EXPECT_FALSE(track.advance(at(-0.2), along(-0.2)));  // before its beginning
  EXPECT_FALSE(track.advance(at(0.1), along(0.1)));
  EXPECT_FALSE(track.advance(at(-0.1), along(-0.1)));  // back over its beginning
  for (double bearing = 0.0; bearing < 4.0; bearing += 0.1)
    EXPECT_FALSE(track.advance(at(bearing), along(bearing))) << bearing;
  EXPECT_TRUE(track.advance(at(4.05), along(4.05)));
}

TEST(MissionTrack, StaysOnItsLoiter) {
  MissionTrack track(makeMission({LoiterCircle{{0.0, 0.0}, 50.0, TurnDirection::kRight}}, {}, "test"),
                     kCriterion);
  EXPECT_TRUE(track.isLoitering());
  for (int i = 0; i < 100; ++i)
    EXPECT_FALSE(track.advance({50.0 * std::cos(i), 50.0 * std::sin(i)}, kNorthward));
  EXPECT_EQ(&track.next(), &track.current());
  MissionTrack nothing;
  EXPECT_TRUE(nothing.empty());
  EXPECT_FALSE(nothing.advance({0.0, 0.0}, kNorthward));
}

// It comes near the end twice, across it, and leaves again.
TEST(MissionTrack, GoesOnWhereAnEndWasMissedTwice) {
  const ArcSegment arc{{0.0, 0.0}, 30.0, TurnDirection::kRight, 0.0, 1.0};
  MissionTrack track(makeMission({arc}, {}, "test"), kCriterion);
  const Vector2d westward(0.0, -14.0);
  for (int pass = 0; pass < 2; ++pass) {
    EXPECT_FALSE(track.advance({16.0, 150.0}, westward));
    EXPECT_FALSE(track.advance({60.0, 20.0}, westward));
    EXPECT_EQ(track.advance({60.0, -100.0}, westward), pass == 1);
  }
  EXPECT_TRUE(track.isLoitering());
}

// The passes of a faster aircraft are wider by the square of its speed.
TEST(MissionTrack, GoesOnWhereAFasterAircraftMissedAnEndTwice) {
  const double scale = 52.0 / 14.0 * 52.0 / 14.0;
  const ArcSegment arc{{0.0, 0.0}, scale * 30.0, TurnDirection::kRight, 0.0, 1.0};
  const Vector2d westward(0.0, -52.0);
  for (const bool is_scaled : {false, true}) {
    MissionTrack track(makeMission({arc}, {}, "test"), kCriterion);
    if (is_scaled) track.setNearScale(scale);
    for (int pass = 0; pass < 2; ++pass) {
      EXPECT_FALSE(track.advance(scale * Vector2d(16.0, 150.0), westward));
      EXPECT_FALSE(track.advance(scale * Vector2d(60.0, 20.0), westward));
      EXPECT_EQ(track.advance(scale * Vector2d(60.0, -100.0), westward), is_scaled && pass == 1);
    }
  }
}

TEST(MissionTrack, WaitsForANumber) {
  MissionTrack track(missionThrough({{0.0, 0.0}, {200.0, 0.0}}, {}, "test"), kCriterion);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(track.advance({kNan, 0.0}, kNorthward));
  EXPECT_FALSE(track.advance({0.0, 0.0}, {kNan, kNan}));
  EXPECT_EQ(track.index(), 0);
}

}  // namespace
