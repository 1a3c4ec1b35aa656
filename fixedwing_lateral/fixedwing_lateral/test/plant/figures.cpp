#include "fixedwing_plant/figures.hpp"

#include <random>

namespace polyfly {
namespace {

constexpr double kTurnRadius = 45.0;    // V^2 / (g tan 24 deg) at 14 m/s [m]
constexpr double kLoiterRadius = 60.0;  // [m]

// Share of the roll bound for turns; the rest is for gusts.
constexpr double kTurnShare = 0.9;

double degrees(double angle) { return angle * kPi / 180.0; }

}  // namespace

TurnPlan turnsInWind(double wind_speed) {
  TurnPlan plan;
  plan.tight = TightTurns::kWiden;
  plan.conditions.wind_speed = wind_speed;
  plan.conditions.roll *= kTurnShare;
  return plan;
}

Mission boxFigure(double size) {
  const double side = 400.0 * size;
  LoiterOptions loiter;
  loiter.radius = 100.0 * size;
  return missionThrough({{0.0, 0.0}, {side, 0.0}, {side, side}, {0.0, side}, {0.0, 0.0}, {side, 0.0}}, loiter,
                        "box");
}

Mission dubinsFigure(const TurnPlan& turns, double size) {
  std::vector<PathPose> poses = {{{0.0, 0.0}, degrees(0.0)},
                                 {{220.0, 60.0}, degrees(60.0)},
                                 {{120.0, 300.0}, degrees(180.0)},
                                 {{-80.0, 200.0}, degrees(-60.0)},
                                 {{60.0, -80.0}, degrees(20.0)}};
  for (PathPose& pose : poses) pose.position *= size;
  LoiterOptions loiter;
  loiter.radius = turns.planned(size * kLoiterRadius);
  loiter.direction = TurnDirection::kLeft;
  return fitTurns(
      makeMission(planDubins(poses, turns.planned(size * kTurnRadius), "figure"), loiter, "figure"), turns,
      "figure");
}

Mission randomMission(int segments, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-300.0, 300.0);
  std::uniform_real_distribution<double> any(-kPi, kPi);
  std::uniform_real_distribution<double> radius(45.0, 70.0);
  std::vector<PathSegment> all;
  PathPose from;
  while (static_cast<int>(all.size()) < segments) {
    const PathPose to{{place(random), place(random)}, any(random)};
    for (const PathSegment& segment : planDubins({from, to}, radius(random), "random"))
      all.push_back(segment);
    from = to;
  }
  return makeMission(std::move(all), LoiterOptions{}, "random");
}

}  // namespace polyfly
