// Reads a mission file and shows what it amounts to: a table of segments, or points along the path as CSV.
#include <cstdio>
#include <string>

#include "command_line/command_line.hpp"
#include "fixedwing_lateral/mission_file.hpp"
#include "polyfly_base/error.hpp"

namespace {

using namespace polyfly;

constexpr double kMostPoints = 1e6;
constexpr double kDegree = 180.0 / kPi;

const char* nameOf(const PathSegment& segment) {
  if (std::holds_alternative<LineSegment>(segment)) return "line";
  if (std::holds_alternative<ArcSegment>(segment)) return "arc";
  if (std::holds_alternative<LoiterCircle>(segment)) return "circle";
  return "spline";
}

double radiusOf(const PathSegment& segment) {
  if (const auto* arc = std::get_if<ArcSegment>(&segment)) return arc->radius;
  if (const auto* circle = std::get_if<LoiterCircle>(&segment)) return circle->radius;
  return 0.0;
}

/// Once round, for a circle.
double shownLength(const PathSegment& segment) {
  return std::holds_alternative<LoiterCircle>(segment) ? 2.0 * kPi * radiusOf(segment) : length(segment);
}

void printTable(const Mission& mission, const TurnConditions& conditions) {
  std::printf("%4s  %-7s %10s %8s %9s %9s %8s %8s\n", "", "segment", "length [m]", "R [m]", "north [m]",
              "east [m]", "course", "roll");
  double whole = 0.0;
  for (std::size_t i = 0; i < mission.segments.size(); ++i) {
    const PathSegment& segment = mission.segments[i];
    const PathPoint start = pointAt(segment, 0.0);
    const double course = kDegree * std::atan2(start.tangent.y(), start.tangent.x());
    const double roll = steepestRoll(segment, conditions);
    std::printf("%4zu  %-7s %10.1f %8.1f %9.1f %9.1f %4.0f deg %4.0f deg%s\n", i, nameOf(segment),
                shownLength(segment), radiusOf(segment), start.position.x(), start.position.y(), course,
                kDegree * roll, roll > conditions.roll ? "  too steep" : "");
    if (!std::holds_alternative<LoiterCircle>(segment)) whole += length(segment);
  }
  std::printf("%.1f m, then the circle for ever\n", whole);
  std::printf("at %.1f m/s in a wind of %.1f m/s and with %.0f degrees of roll, circles need %.1f m\n",
              conditions.airspeed, conditions.wind_speed, kDegree * plannedRoll(conditions),
              leastRadius(conditions));
  const std::string steep = describeSteep(mission.segments, conditions);
  if (!steep.empty()) std::printf("%s; it will be left there\n", steep.c_str());
}

void printPoints(const Mission& mission, double step) {
  std::printf("segment,north,east\n");
  for (std::size_t i = 0; i < mission.segments.size(); ++i) {
    const double whole = shownLength(mission.segments[i]);
    if (whole / step > kMostPoints) throw Error("--points: more than 1000000 points on a segment");
    const int count = std::max(1, static_cast<int>(whole / step));
    for (int k = 0; k <= count; ++k) {
      const PathPoint point = pointAt(mission.segments[i], whole * k / count);
      std::printf("%zu,%.3f,%.3f\n", i, point.position.x(), point.position.y());
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Checks a mission of the fixed wing and shows its segments.", "mission");
  std::string path;
  double step = 0.0;
  TurnConditions conditions;
  double roll = kDegree * conditions.roll;
  app.add_option("file", path, "Mission file, see fixedwing_lateral/README.md.")->required();
  app.add_option("--points", step, "Print the path as CSV instead, with points this far apart [m].")
      ->check(numberAbove(0.0));
  app.add_option("--airspeed", conditions.airspeed, "Airspeed for the computation of the roll [m/s].")
      ->check(numberAbove(0.0));
  app.add_option("--wind", conditions.wind_speed, "Wind speed, from the worst direction [m/s].")
      ->check(numberFrom(0.0));
  app.add_option("--roll", roll, "Greatest roll in turns [deg].")->check(numberAbove(0.0));
  addRemoved(app, {"--loiter-radius"},
             "was removed; write 'loiter: {radius: ..., direction: ...}' into the file");
  addRemoved(app, {"--tight", "--turn-gain", "--roll-rate", "--deviation"},
             "was removed; write 'turns: {airspeed: ..., wind: ..., roll: ..., tight: ...}' into the file");
  return runTool(app, argc, argv, [&] {
    conditions.roll = roll / kDegree;
    checkTurns(conditions, "conditions");
    const Mission mission = loadMission(path, LoiterOptions{});
    if (step > 0.0)
      printPoints(mission, step);
    else
      printTable(mission, conditions);
    return 0;
  });
}
