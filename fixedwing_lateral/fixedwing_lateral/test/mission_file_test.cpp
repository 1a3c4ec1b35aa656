// Missions from files: what each part becomes, and what is said of files that are wrong.
#include "fixedwing_lateral/mission_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <fstream>

#include "fixedwing_plant/flight_loop.hpp"
#include "polyfly_base/error.hpp"
#include "project_root.hpp"

namespace {

using namespace polyfly;
using Eigen::Vector2d;

Mission parse(const std::string& text) { return parseMission(text, "m.yaml", {}); }

std::string complaintOf(const std::string& text) {
  try {
    parse(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "none";
}

constexpr const char* kEveryPart = R"(loiter: {radius: 80, direction: left}
path:
  - lines: [[0, 0], [300, 0], [300, 200]]
  - dubins: {radius: 50, poses: [[300, 200, 1.5708], [100, 420, 3.1416]]}
  - spline: [[100, 420], [50, 410], [0, 440]]
  - arc: {centre: [0, 500], radius: 60, direction: right, start_bearing: -1.5708, sweep: 3.0}
)";

TEST(MissionFile, HasEachPartInItsOrder) {
  const Mission mission = parse(kEveryPart);
  const std::vector<PathSegment> dubins =
      planDubins({{{300.0, 200.0}, 1.5708}, {{100.0, 420.0}, 3.1416}}, 50.0, "test");
  ASSERT_EQ(mission.segments.size(), 2U + dubins.size() + 3U);
  EXPECT_EQ(std::get<LineSegment>(mission.segments[1]).b, Vector2d(300.0, 200.0));
  for (std::size_t i = 0; i < dubins.size(); ++i)
    EXPECT_EQ(length(mission.segments[2 + i]), length(dubins[i]));
  const PathSegment& spline = mission.segments[2 + dubins.size()];
  ASSERT_TRUE(std::holds_alternative<CurveSegment>(spline));
  EXPECT_LT((pointAt(spline, length(spline)).position - Vector2d(0.0, 440.0)).norm(), 1e-9);
  EXPECT_LT((closestPoint(spline, {50.0, 410.0}).point.position - Vector2d(50.0, 410.0)).norm(), 1e-6);
  const auto& arc = std::get<ArcSegment>(mission.segments[3 + dubins.size()]);
  EXPECT_EQ(arc.direction, TurnDirection::kRight);
  EXPECT_EQ(arc.sweep, 3.0);
  const auto& loiter = std::get<LoiterCircle>(mission.segments.back());
  EXPECT_EQ(loiter.radius, 80.0);
  EXPECT_EQ(loiter.direction, TurnDirection::kLeft);
}

TEST(MissionFile, EndsInTheCirclesOfItsOwnOrOfTheOptions) {
  const Mission own = parse(
      "path:\n  - lines: [[0, 0], [9, 0]]\n"
      "  - circle: {centre: [50, 60], radius: 40, direction: left}\n");
  EXPECT_EQ(std::get<LoiterCircle>(own.segments.back()).centre, Vector2d(50.0, 60.0));
  const Mission default_end =
      parseMission("path: [{lines: [[0, 0], [9, 0]]}]", "m", {70.0, TurnDirection::kLeft});
  EXPECT_EQ(std::get<LoiterCircle>(default_end.segments.back()).radius, 70.0);
}

TEST(MissionFile, KeepsItsSplinesForAsLongAsItIsFlown) {
  GuidanceOptions options;
  LateralGuidance guidance(options, "test");
  guidance.setMission(parse("path: [{spline: [[0, 0], [150, 20], [300, -30], [500, 0]]}]"));
  AircraftState start;
  start.ground_velocity = {14.0, 0.0};
  ChapterAircraft aircraft(LateralModel{}, start, 14.0, {2.0, 3.0});
  Sensors sensors({}, 1);
  const auto samples = flyLaw(aircraft, sensors, lawOf(guidance), options.period, 60.0);
  // The mission ends with a loiter.
  EXPECT_TRUE(samples.back().output.loitering);
  double late = 0.0;
  for (const FlightSample& sample : samples) {
    if (sample.time > 10.0 && sample.output.segment == 0)
      late = std::max(late, std::abs(sample.output.error.track));
  }
  EXPECT_GT(late, 0.0);
  EXPECT_LT(late, 3.0);
}

TEST(MissionFile, SaysWhatIsWrongAndWhere) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "m.yaml:1: file: must not be empty"},
      {"path: [", "is not valid YAML"},
      {"pth: []", "m.yaml:1: pth: unknown key"},
      {"path: []", "m.yaml:1: path: must have at least one part"},
      {"path: 3", "m.yaml:1: path: must be a list"},
      {"path:\n  - {}", "m.yaml:2: path[0]: must be one of lines, dubins, spline, arc, circle"},
      {"path:\n  - walk: [[0, 0], [1, 1]]", "m.yaml:2: path[0].walk: unknown key"},
      {"path:\n  - {lines: [[0, 0], [1, 1]], spline: [[0, 0], [1, 1]]}",
       "path[0]: must be one part, has lines and spline"},
      {"path:\n  - lines: [[0, 0]]", "m.yaml:2: path[0].lines: must be at least two points"},
      {"path:\n  - lines: [[0, 0], [0, 0]]",
       "path[0].lines[1]: must be at least 0.1 m from the point before"},
      {"path:\n  - lines: [[0, 0], [5]]", "path[0].lines[1]: must be [north, east]"},
      {"path:\n  - lines: [[0, 0], [5, .nan]]", "path[0].lines[1][1]: must be a finite number"},
      {"path:\n  - lines: [[0, 0], [5, x]]", "path[0].lines[1][1]: must be a finite number"},
      {"path:\n  - dubins: {radius: 0, poses: [[0, 0, 0], [9, 0, 0]]}",
       "path[0].dubins.radius: must be positive"},
      {"path:\n  - dubins: {radius: 9, poses: [[0, 0, 0]]}",
       "path[0].dubins.poses: must be at least two poses"},
      {"path:\n  - dubins: {radius: 9, poses: [[0, 0, 0], [0, 0, 0]]}",
       "dubins.poses: must not all be the same"},
      {"path:\n  - dubins: {radius: 9, poses: [[0, 0], [9, 0]]}",
       "dubins.poses[0]: must be [north, east, heading]"},
      {"path:\n  - dubins: {poses: [[0, 0, 0], [9, 0, 0]]}", "path[0].dubins.radius: missing"},
      {"path:\n  - spline: [[0, 0], [0, 0], [1, 1]]", "path[0].spline: spline: point 1: must differ"},
      {"path:\n  - arc: {centre: [0, 0], radius: 9, direction: up, start_bearing: 0, sweep: 1}",
       "path[0].arc.direction: must be right or left, got 'up'"},
      {"path:\n  - arc: {centre: [0, 0], radius: 9, direction: left, start_bearing: 0, sweep: 7}",
       "path[0].arc: arc: sweep: must lie between 0 and 2 pi"},
      {"path:\n  - lines: [[0, 0], [9, 0]]\n  - lines: [[12, 0], [20, 0]]",
       "m.yaml:3: path[1]: must begin where the part before ends, is 3 m away"},
      {"path:\n  - circle: {centre: [0, 0], radius: 9, direction: left}\n  - lines: [[0, 0], [9, 0]]",
       "m.yaml:3: path[1]: nothing can follow a circle"},
      {"loiter: {radius: -1, direction: left}\npath:\n  - lines: [[0, 0], [9, 0]]",
       "m.yaml:1: loiter.radius: must be positive"},
      {"loiter: {radius: 9}\npath:\n  - lines: [[0, 0], [9, 0]]", "m.yaml:1: loiter.direction: missing"},
  };
  for (const auto& [text, sentence] : cases) {
    const std::string complaint = complaintOf(text);
    EXPECT_NE(complaint.find(sentence), std::string::npos) << text << "\nsays: " << complaint;
  }
}

// Every shortening of a good file is refused with a sentence, or is a good file itself.
TEST(MissionFile, SurvivesBeingCutOffAnywhere) {
  const std::string whole = kEveryPart;
  int refused = 0;
  for (std::size_t size = 0; size < whole.size(); ++size) {
    const std::string complaint = complaintOf(whole.substr(0, size));
    if (complaint == "none") continue;
    ++refused;
    EXPECT_EQ(complaint.rfind("m.yaml:", 0), 0U) << complaint;
  }
  EXPECT_GT(refused, 200);
}

TEST(MissionFile, IsReadFromDisk) {
  EXPECT_THROW(loadMission("/nowhere/mission.yaml", {}), Error);
  const Mission mission = loadMission(projectRoot() + "/fixedwing_lateral/missions/survey.yaml", {});
  EXPECT_GT(mission.segments.size(), 8U);
}

}  // namespace
