#include "fixedwing_lateral/mission_file.hpp"

#include <cstdio>
#include <memory>

#include "fixedwing_lateral/spline_path.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "polyfly_base/yaml_field.hpp"

namespace polyfly {
namespace {

using Eigen::Vector2d;

std::vector<double> numbers(const YamlField& field, std::size_t count, const char* names) {
  const std::vector<YamlField> items = field.items();
  if (items.size() != count) field.fail(std::string("must be ") + names);
  std::vector<double> values;
  values.reserve(count);
  for (const YamlField& item : items) values.push_back(item.number());
  return values;
}

Vector2d readPoint(const YamlField& field) {
  const std::vector<double> values = numbers(field, 2, "[north, east]");
  return {values[0], values[1]};
}

std::vector<Vector2d> readPoints(const YamlField& field) {
  std::vector<Vector2d> points;
  for (const YamlField& item : field.items()) points.push_back(readPoint(item));
  if (points.size() < 2) field.fail("must be at least two points");
  return points;
}

double readRadius(const YamlField& field) {
  const double radius = field.number();
  if (!(radius > 0.0)) field.fail("must be positive");
  return radius;
}

TurnDirection readDirection(const YamlField& field) {
  const std::string direction = field.text();
  if (direction == "right") return TurnDirection::kRight;
  if (direction == "left") return TurnDirection::kLeft;
  field.fail("must be right or left, got '" + direction + "'");
}

LoiterOptions readLoiter(const YamlField& field) {
  field.checkKeys({"radius", "direction"}, {});
  return {readRadius(field.at("radius")), readDirection(field.at("direction"))};
}

TurnPlan readTurns(const YamlField& field) {
  for (const char* removed : {"turn_gain", "roll_rate", "deviation"}) {
    if (field.has(removed))
      field.fail(std::string(removed) +
                 " is removed: give a smaller roll, or let the node widen (path/tight_turns)");
  }
  field.checkKeys({"airspeed", "wind"}, {"roll", "tight"});
  TurnPlan plan;
  plan.conditions.airspeed = field.at("airspeed").number();
  plan.conditions.wind_speed = field.at("wind").number();
  if (field.has("roll")) plan.conditions.roll = field.at("roll").number();
  const std::string tight = field.has("tight") ? field.at("tight").text() : "refuse";
  try {
    plan.tight = tightTurnsOf(tight, "tight");
    checkTurns(plan.conditions, "turns");
  } catch (const Error& error) {
    field.fail(error.what());
  }
  return plan;
}

/// What a part amounts to.
struct Part {
  std::vector<PathSegment> segments;
  // Curve to which one of the segments points.
  std::shared_ptr<const PathCurve> curve;
  // True when the part need not begin where the one before ended.
  bool may_jump = false;
};

Part readLines(const YamlField& field, const TurnPlan&) {
  Part part;
  const std::vector<Vector2d> points = readPoints(field);
  for (std::size_t i = 1; i < points.size(); ++i) {
    if ((points[i] - points[i - 1]).norm() < kSamePoint)
      field.items()[i].fail("must be at least 0.1 m from the point before");
    part.segments.emplace_back(LineSegment{points[i - 1], points[i]});
  }
  return part;
}

// Where turns are planned for, the least radius is the default.
double readDubinsRadius(const YamlField& field, const TurnPlan& plan) {
  if (plan.tight != TightTurns::kKeep && !field.has("radius")) return leastRadius(plan.conditions);
  return plan.planned(readRadius(field.at("radius")));
}

Part readDubins(const YamlField& field, const TurnPlan& plan) {
  field.checkKeys({"poses"}, {"radius"});
  std::vector<PathPose> poses;
  for (const YamlField& item : field.at("poses").items()) {
    const std::vector<double> values = numbers(item, 3, "[north, east, heading]");
    poses.push_back({{values[0], values[1]}, values[2]});
  }
  if (poses.size() < 2) field.at("poses").fail("must be at least two poses");
  Part part;
  part.segments = planDubins(poses, readDubinsRadius(field, plan), "dubins");
  if (part.segments.empty()) field.at("poses").fail("must not all be the same");
  return part;
}

Part readSpline(const YamlField& field, const TurnPlan&) {
  Part part;
  const std::vector<Vector2d> points = readPoints(field);
  try {
    part.curve = std::make_shared<SplinePath>(points, "spline");
  } catch (const Error& error) {
    field.fail(error.what());
  }
  part.segments.emplace_back(CurveSegment{part.curve.get()});
  return part;
}

Part readArc(const YamlField& field, const TurnPlan&) {
  field.checkKeys({"centre", "radius", "direction", "start_bearing", "sweep"}, {});
  const ArcSegment arc{readPoint(field.at("centre")), readRadius(field.at("radius")),
                       readDirection(field.at("direction")), field.at("start_bearing").number(),
                       field.at("sweep").number()};
  try {
    checkSegment(arc, "arc");
  } catch (const Error& error) {
    field.fail(error.what());
  }
  return {{arc}, nullptr, false};
}

Part readCircle(const YamlField& field, const TurnPlan&) {
  field.checkKeys({"centre", "radius", "direction"}, {});
  const LoiterCircle circle{readPoint(field.at("centre")), readRadius(field.at("radius")),
                            readDirection(field.at("direction"))};
  return {{circle}, nullptr, true};
}

Part readPart(const YamlField& field, const TurnPlan& plan) {
  field.checkKeys({}, {"lines", "dubins", "spline", "arc", "circle"});
  using Reader = Part (*)(const YamlField&, const TurnPlan&);
  const std::pair<const char*, Reader> readers[] = {{"lines", readLines},
                                                    {"dubins", readDubins},
                                                    {"spline", readSpline},
                                                    {"arc", readArc},
                                                    {"circle", readCircle}};
  const std::pair<const char*, Reader>* chosen = nullptr;
  for (const auto& reader : readers) {
    if (!field.has(reader.first)) continue;
    if (chosen != nullptr)
      field.fail("must be one part, has " + std::string(chosen->first) + " and " + reader.first);
    chosen = &reader;
  }
  if (chosen == nullptr) field.fail("must be one of lines, dubins, spline, arc, circle");
  return chosen->second(field.at(chosen->first), plan);
}

void checkJoint(const YamlField& field, const PathSegment& before, const PathSegment& after) {
  const double gap = (pointAt(after, 0.0).position - pointAt(before, length(before)).position).norm();
  if (gap <= kPartGap) return;
  char text[120];
  std::snprintf(text, sizeof text, "must begin where the part before ends, is %.6g m away", gap);
  field.fail(text);
}

}  // namespace

Mission parseMission(const std::string& text, const std::string& source, const LoiterOptions& loiter,
                     const TurnPlan& turns) {
  const YamlField root = YamlField::parse(text, source);
  root.checkKeys({"path"}, {"loiter", "turns"});
  const TurnPlan plan = root.has("turns") ? readTurns(root.at("turns")) : turns;
  const LoiterOptions end = root.has("loiter") ? readLoiter(root.at("loiter")) : loiter;
  std::vector<PathSegment> segments;
  std::vector<std::shared_ptr<const PathCurve>> curves;
  for (const YamlField& item : root.at("path").items()) {
    Part part = readPart(item, plan);
    if (!segments.empty()) {
      if (std::holds_alternative<LoiterCircle>(segments.back())) item.fail("nothing can follow a circle");
      if (!part.may_jump) checkJoint(item, segments.back(), part.segments.front());
    }
    segments.insert(segments.end(), part.segments.begin(), part.segments.end());
    if (part.curve) curves.push_back(std::move(part.curve));
  }
  if (segments.empty()) root.at("path").fail("must have at least one part");
  Mission mission = makeMission(std::move(segments), end, source);
  mission.curves = std::move(curves);
  return fitTurns(std::move(mission), plan, source);
}

Mission loadMission(const std::string& path, const LoiterOptions& loiter, const TurnPlan& turns) {
  return parseMission(readText(path), path, loiter, turns);
}

}  // namespace polyfly
