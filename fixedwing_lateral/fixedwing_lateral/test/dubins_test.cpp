// Shortest paths against closed forms, against a search over the first turn, and by flying them.
#include "fixedwing_lateral/dubins.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

constexpr double kReached = 1e-9;  // [m], [rad]
constexpr double kTurn = 2.0 * kPi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Flies the curvature and the length of each segment from `pose`, and no other number of it: complex numbers
// z = north + i east, dz/ds = exp(i heading).
PathPose flown(PathPose pose, const std::vector<PathSegment>& segments) {
  for (const PathSegment& segment : segments) {
    const double distance = length(segment);
    double turned = 0.0;
    if (const auto* arc = std::get_if<ArcSegment>(&segment))
      turned = (arc->direction == TurnDirection::kRight ? 1.0 : -1.0) * distance / arc->radius;
    const double half = turned / 2.0;
    const double chord = half == 0.0 ? distance : distance * std::sin(half) / half;
    pose.position += chord * Vector2d(std::cos(pose.heading + half), std::sin(pose.heading + half));
    pose.heading += turned;
  }
  return pose;
}

std::vector<PathSegment> partsOf(const DubinsPath& path) {
  return {path.segments.begin(), path.segments.begin() + path.segment_count};
}

void expectReached(const PathPose& got, const PathPose& wanted) {
  EXPECT_LT((got.position - wanted.position).norm(), kReached);
  EXPECT_NEAR(std::remainder(got.heading - wanted.heading, kTurn), 0.0, kReached);
}

// The segments lie where the flight leads, too, one beginning where the other ends.
void expectJoined(const PathPose& from, const std::vector<PathSegment>& segments, const PathPose& to) {
  PathPoint at{from.position, Vector2d(std::cos(from.heading), std::sin(from.heading))};
  for (const PathSegment& segment : segments) {
    EXPECT_NO_THROW(checkSegment(segment, "planned"));
    const PathPoint start = pointAt(segment, 0.0);
    EXPECT_LT((start.position - at.position).norm(), kReached);
    EXPECT_LT((start.tangent - at.tangent).norm(), 1e-7);
    at = pointAt(segment, length(segment));
  }
  EXPECT_LT((at.position - to.position).norm(), kReached);
  EXPECT_LT((at.tangent - Vector2d(std::cos(to.heading), std::sin(to.heading))).norm(), 1e-7);
}

// ---- The search. For a word the first turn t alone is free: the rest follows, and one equation is left to
// t.

struct Found {
  double length;
  bool long_middle;  // CCC: the middle arc exceeds half a turn
};

struct Search {
  PathPose from;
  PathPose to;
  double radius;
  double first;   // 1 right, -1 left
  double middle;  // 0 straight
  double last;

  static double positive(double angle) {
    const double rest = std::fmod(angle, kTurn);
    return rest < 0.0 ? rest + kTurn : rest;
  }
  static Vector2d rightOf(double heading) { return {-std::sin(heading), std::cos(heading)}; }
  Vector2d goalCentre() const { return to.position + last * radius * rightOf(to.heading); }
  PathPose afterFirst(double turn) const {
    const Vector2d centre = from.position + first * radius * rightOf(from.heading);
    const double heading = from.heading + first * turn;
    return {centre - first * radius * rightOf(heading), heading};
  }
  // Zero where the rest of the word fits.
  double misfit(double turn) const {
    const PathPose at = afterFirst(turn);
    const Vector2d to_goal = goalCentre() - at.position;
    // The straight part must touch the last circle.
    if (middle == 0.0) return rightOf(at.heading).dot(to_goal) - last * radius;
    return (to_goal - middle * radius * rightOf(at.heading)).norm() - 2.0 * radius;
  }
  Found complete(double turn) const {
    const PathPose at = afterFirst(turn);
    const Vector2d to_goal = goalCentre() - at.position;
    if (middle == 0.0) {
      const double straight = to_goal.dot(Vector2d(std::cos(at.heading), std::sin(at.heading)));
      if (straight < 0.0) return {kInfinity, false};
      return {radius * (turn + positive(last * (to.heading - at.heading))) + straight, false};
    }
    // On the middle circle, the way out to the goal's circle is 90 degrees to the left of a right turn's way.
    const Vector2d out = to_goal - middle * radius * rightOf(at.heading);
    const double heading = std::atan2(out.y(), out.x()) + middle * kPi / 2.0;
    const double second = positive(middle * (heading - at.heading));
    return {radius * (turn + second + positive(last * (to.heading - heading))), second > kPi};
  }
  std::vector<Found> all() const {
    constexpr int kGrid = 1440;
    std::vector<Found> found;
    for (int i = 0; i < kGrid; ++i) {
      double low = kTurn * i / kGrid;
      double high = kTurn * (i + 1) / kGrid;
      if ((misfit(low) < 0.0) == (misfit(high) < 0.0)) continue;
      const bool rising = misfit(low) < 0.0;
      for (int k = 0; k < 60; ++k) {
        const double centre = (low + high) / 2.0;
        ((misfit(centre) < 0.0) == rising ? low : high) = centre;
      }
      const Found candidate = complete((low + high) / 2.0);
      if (candidate.length < kInfinity) found.push_back(candidate);
    }
    return found;
  }
};

Search searchOf(DubinsWord word, const PathPose& from, const PathPose& to, double radius) {
  static const std::map<char, double> kSides = {{'L', -1.0}, {'S', 0.0}, {'R', 1.0}};
  const std::string name = toString(word);
  return {from, to, radius, kSides.at(name[0]), kSides.at(name[1]), kSides.at(name[2])};
}

class Poses {
 public:
  explicit Poses(unsigned seed) : random_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }
  PathPose pose(double reach) {
    return {{between(-reach, reach), between(-reach, reach)}, between(-9.0, 9.0)};
  }

 private:
  std::mt19937 random_;
};

TEST(Dubins, EveryWordEqualsASearchOverTheFirstTurn) {
  Poses poses(21);
  std::map<DubinsWord, int> compared;
  std::map<DubinsWord, int> shortest_of;
  for (int i = 0; i < 300; ++i) {
    const double radius = poses.between(20.0, 80.0);
    const double reach = poses.between(0.5, 3.0) * radius;
    const PathPose from = poses.pose(reach);
    const PathPose to = poses.pose(reach);
    double best = kInfinity;
    for (const DubinsWord word : kDubinsWords) {
      const Search search = searchOf(word, from, to, radius);
      const auto path = dubinsPath(word, from, to, radius);
      double expected = kInfinity;
      for (const Found& found : search.all()) {
        // Words with a short middle arc count for the optimum too.
        best = std::min(best, found.length);
        if (search.middle == 0.0 || found.long_middle) expected = std::min(expected, found.length);
      }
      ASSERT_EQ(path.has_value(), expected < kInfinity) << toString(word) << ", pair " << i;
      if (!path) continue;
      EXPECT_NEAR(path->length, expected, 1e-6) << toString(word) << ", pair " << i;
      ++compared[word];
    }
    const DubinsPath shortest = shortestDubinsPath(from, to, radius);
    EXPECT_NEAR(shortest.length, best, 1e-6) << "pair " << i;
    ++shortest_of[shortest.word];
  }
  for (const DubinsWord word : kDubinsWords) {
    EXPECT_GE(compared[word], 50) << toString(word);
    EXPECT_GE(shortest_of[word], 5) << toString(word);
  }
}

TEST(Dubins, EveryWordReachesThePose) {
  Poses poses(22);
  int paths = 0;
  for (int i = 0; i < 5000; ++i) {
    const double radius = poses.between(10.0, 100.0);
    const double reach = std::pow(10.0, poses.between(-1.0, 3.0));
    const PathPose from = poses.pose(reach);
    const PathPose to = poses.pose(reach);
    for (const DubinsWord word : kDubinsWords) {
      const auto path = dubinsPath(word, from, to, radius);
      if (!path) continue;
      ++paths;
      double sum = 0.0;
      for (const PathSegment& segment : partsOf(*path)) sum += length(segment);
      EXPECT_NEAR(path->length, sum, kReached);
      EXPECT_GE(path->length, (to.position - from.position).norm() - kReached);
      expectReached(flown(from, partsOf(*path)), to);
      expectJoined(from, partsOf(*path), to);
    }
  }
  EXPECT_GT(paths, 15000);
}

struct Known {
  const char* what;
  // Goal; the start is (0, 0), heading north, with radius 50.
  PathPose to;
  double length;
  int segments;
};

constexpr double kRadius = 50.0;

const Known kKnown[] = {
    {"where it is", {{0.0, 0.0}, 0.0}, 0.0, 0},
    {"where it is, a turn later", {{0.0, 0.0}, kTurn}, 0.0, 0},
    {"straight ahead", {{300.0, 0.0}, 0.0}, 300.0, 1},
    {"half a turn to the right", {{0.0, 100.0}, kPi}, 50.0 * kPi, 1},
    {"half a turn to the left", {{0.0, -100.0}, -kPi}, 50.0 * kPi, 1},
    {"a quarter to the right", {{50.0, 50.0}, kPi / 2.0}, 25.0 * kPi, 1},
    {"a quarter to the left", {{50.0, -50.0}, -kPi / 2.0}, 25.0 * kPi, 1},
    {"back at a distance of 8 radii", {{0.0, 400.0}, kPi}, 50.0 * kPi + 300.0, 3},
    {"a quarter and a straight", {{50.0, 250.0}, kPi / 2.0}, 25.0 * kPi + 200.0, 2},
    {"an S of two quarters, circles just touching", {{100.0, 100.0}, 0.0}, 50.0 * kPi, 2},
    {"an S of two quarters to the left", {{100.0, -100.0}, 0.0}, 50.0 * kPi, 2},
    {"a change of lane by two radii",
     {{200.0, 100.0}, 0.0},
     std::sqrt(4e4 - 1e4) + 2.0 * kRadius* std::asin(0.5),
     3},
    {"about face on the spot: 60, 300 and 60 degrees", {{0.0, 0.0}, kPi}, 7.0 / 3.0 * kPi* kRadius, 3},
};

TEST(Dubins, KnownLengths) {
  for (const Known& known : kKnown) {
    const PathPose from;
    const DubinsPath path = shortestDubinsPath(from, known.to, kRadius);
    EXPECT_NEAR(path.length, known.length, kReached) << known.what << ", " << toString(path.word);
    EXPECT_EQ(path.segment_count, known.segments) << known.what;
    expectReached(flown(from, partsOf(path)), known.to);
  }
}

// The same cases anywhere and in any direction: rounding must not turn an arc of nothing into a full turn,
// nor lose circles that just touch.
TEST(Dubins, KnownLengthsSurviveRounding) {
  Poses poses(23);
  for (int i = 0; i < 2000; ++i) {
    const PathPose from = poses.pose(i % 2 == 0 ? 100.0 : 1e4);
    const double cosine = std::cos(from.heading);
    const double sine = std::sin(from.heading);
    for (const Known& known : kKnown) {
      const Vector2d& move = known.to.position;
      const Vector2d turned(cosine * move.x() - sine * move.y(), sine * move.x() + cosine * move.y());
      const PathPose to{from.position + turned, from.heading + known.to.heading};
      const DubinsPath path = shortestDubinsPath(from, to, kRadius);
      // A tangent that only just exists turns by the root of a rounding.
      EXPECT_NEAR(path.length, known.length, 1e-4) << known.what << ", " << toString(path.word);
      const PathPose end = flown(from, partsOf(path));
      EXPECT_LT((end.position - to.position).norm(), 1e-8) << known.what;
    }
  }
}

// Where a word and its mirror image are equally long, the place and the direction must not decide.
TEST(Dubins, TiesGoToTheFirstWord) {
  Poses poses(27);
  int mirrored_words = 0;
  for (int i = 0; i < 2000; ++i) {
    const PathPose from = poses.pose(1000.0);
    const Vector2d ahead(std::cos(from.heading), std::sin(from.heading));
    const PathPose about_face{from.position, from.heading + kPi};
    EXPECT_EQ(shortestDubinsPath(from, about_face, kRadius).word, DubinsWord::kRlr);
    const PathPose meeting{from.position + 400.0 * ahead, from.heading + kPi};
    EXPECT_EQ(shortestDubinsPath(from, meeting, kRadius).word, DubinsWord::kLsr);
    const auto other = dubinsPath(DubinsWord::kRsl, from, meeting, kRadius);
    ASSERT_TRUE(other.has_value());
    const double least = shortestDubinsPath(from, meeting, kRadius).length;
    mirrored_words += other->length < least ? 1 : 0;
  }
  EXPECT_GT(mirrored_words, 100);  // rounding alone would often have decided otherwise
}

// No path can be shorter than the plan: bang-bang controls of up to three parts that end near the goal.
TEST(Dubins, NoSampledFlightIsShorter) {
  Poses poses(24);
  int near = 0;
  for (int i = 0; i < 30000; ++i) {
    std::vector<PathSegment> parts;
    double flight = 0.0;
    for (int part = 0; part < 3; ++part) {
      const double kind = poses.between(0.0, 3.0);
      if (kind < 1.0)
        parts.push_back(LineSegment{{0.0, 0.0}, {poses.between(0.01, 200.0), 0.0}});
      else
        parts.push_back(ArcSegment{{0.0, 0.0},
                                   kRadius,
                                   kind < 2.0 ? TurnDirection::kLeft : TurnDirection::kRight,
                                   0.0,
                                   poses.between(0.001, kTurn - 0.001)});
      flight += length(parts.back());
    }
    const PathPose from;
    const PathPose to = flown(from, parts);
    const DubinsPath shortest = shortestDubinsPath(from, to, kRadius);
    EXPECT_LE(shortest.length, flight + kReached);
    if (shortest.length > flight - 1e-6) ++near;
  }
  EXPECT_GT(near, 1500);  // many of the flights were the shortest themselves
}

TEST(Dubins, ReversedAndMirroredPathsAreAsLong) {
  Poses poses(25);
  for (int i = 0; i < 500; ++i) {
    const PathPose from = poses.pose(100.0);
    const PathPose to = poses.pose(100.0);
    const double length_there = shortestDubinsPath(from, to, kRadius).length;
    const PathPose back_from{to.position, to.heading + kPi};
    const PathPose back_to{from.position, from.heading + kPi};
    EXPECT_NEAR(shortestDubinsPath(back_from, back_to, kRadius).length, length_there, 1e-7);
    const auto mirrored = [](const PathPose& pose) {
      return PathPose{{pose.position.x(), -pose.position.y()}, -pose.heading};
    };
    EXPECT_NEAR(shortestDubinsPath(mirrored(from), mirrored(to), kRadius).length, length_there, 1e-7);
  }
}

TEST(PlanDubins, LeadsThroughTheWaypoints) {
  Poses poses(26);
  std::vector<PathPose> waypoints;
  waypoints.reserve(101);
  for (int i = 0; i < 100; ++i) waypoints.push_back(poses.pose(500.0));
  waypoints.push_back(waypoints.back());  // twice: nothing to fly
  const std::vector<PathSegment> plan = planDubins(waypoints, 60.0, "mission");
  double expected = 0.0;
  for (std::size_t i = 1; i < waypoints.size(); ++i)
    expected += shortestDubinsPath(waypoints[i - 1], waypoints[i], 60.0).length;
  double planned = 0.0;
  for (const PathSegment& segment : plan) planned += length(segment);
  EXPECT_NEAR(planned, expected, 1e-6);
  expectJoined(waypoints.front(), plan, waypoints.back());
  for (const PathPose& waypoint : waypoints) {
    double nearest = kInfinity;
    for (const PathSegment& segment : plan)
      nearest = std::min(
          nearest, (closestPoint(segment, waypoint.position).point.position - waypoint.position).norm());
    EXPECT_LT(nearest, kReached);
  }
}

TEST(PlanDubins, RefusesWhatCannotBePlanned) {
  const auto refused = [](const std::vector<PathPose>& waypoints, double radius, const std::string& text) {
    try {
      planDubins(waypoints, radius, "mission.yaml");
      ADD_FAILURE() << "taken: " << text;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find("mission.yaml: " + text), 0u) << error.what();
    }
  };
  const PathPose good{{1.0, 2.0}, 3.0};
  const double nan = std::nan("");
  refused({}, 60.0, "waypoints: ");
  refused({good}, 60.0, "waypoints: ");
  for (const double radius : {0.0, -1.0, nan, HUGE_VAL}) refused({good, good}, radius, "radius: ");
  refused({good, {{nan, 0.0}, 0.0}}, 60.0, "waypoints[1]: ");
  refused({{{0.0, 0.0}, nan}, good}, 60.0, "waypoints[0]: ");
}

}  // namespace
