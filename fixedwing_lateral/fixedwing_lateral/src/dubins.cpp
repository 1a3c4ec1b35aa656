#include "fixedwing_lateral/dubins.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr double kTurn = 2.0 * kPi;
constexpr double kTie = 1e-9;  // relative difference of lengths that counts as none
constexpr double kRounding = 64.0 * std::numeric_limits<double>::epsilon();

double sign(TurnDirection direction) noexcept { return direction == TurnDirection::kRight ? 1.0 : -1.0; }

TurnDirection opposite(TurnDirection direction) noexcept {
  return direction == TurnDirection::kRight ? TurnDirection::kLeft : TurnDirection::kRight;
}

/// In [0, 2 pi).
double wrapPositive(double angle) noexcept {
  const double rest = std::fmod(angle, kTurn);
  const double positive = rest < 0.0 ? rest + kTurn : rest;
  return positive < kTurn ? positive : 0.0;
}

double bearingOf(const Eigen::Vector2d& vector) noexcept { return std::atan2(vector.y(), vector.x()); }

Eigen::Vector2d unit(double bearing) noexcept { return {std::cos(bearing), std::sin(bearing)}; }

/// Clockwise, the way along a circle is 90 degrees to the right of the way out from its centre.
double bearingAtHeading(double heading, TurnDirection direction) noexcept {
  return heading - sign(direction) * kPi / 2.0;
}

Eigen::Vector2d circleCentre(const PathPose& pose, TurnDirection direction, double radius) noexcept {
  return pose.position - radius * unit(bearingAtHeading(pose.heading, direction));
}

struct TurnWord {
  TurnDirection first;
  TurnDirection last;
  // True: the middle part is straight. False: it is a turn opposite to the others.
  bool straight;
};

TurnWord turnsOf(DubinsWord word) noexcept {
  constexpr TurnDirection kL = TurnDirection::kLeft;
  constexpr TurnDirection kR = TurnDirection::kRight;
  switch (word) {
    case DubinsWord::kLsl:
      return {kL, kL, true};
    case DubinsWord::kRsr:
      return {kR, kR, true};
    case DubinsWord::kLsr:
      return {kL, kR, true};
    case DubinsWord::kRsl:
      return {kR, kL, true};
    case DubinsWord::kRlr:
      return {kR, kR, false};
    case DubinsWord::kLrl:
      return {kL, kL, false};
  }
  return {kL, kL, true};
}

/// The first and the last circle, and what lies between them.
struct Circles {
  Eigen::Vector2d first;
  Eigen::Vector2d last;
  // Distance between the centres.
  double distance;
  // Bearing from the first centre to the last.
  double bearing;
  // Headings of the path at its start and its end.
  double heading_from;
  double heading_to;
  // Rounding error of `distance`.
  double noise;
};

Circles circlesOf(const TurnWord& turns, const PathPose& from, const PathPose& to, double radius) noexcept {
  Circles circles;
  circles.first = circleCentre(from, turns.first, radius);
  circles.last = circleCentre(to, turns.last, radius);
  const Eigen::Vector2d between = circles.last - circles.first;
  circles.distance = between.norm();
  circles.bearing = bearingOf(between);
  circles.heading_from = from.heading;
  circles.heading_to = to.heading;
  circles.noise = kRounding * (from.position.norm() + to.position.norm() + radius);
  return circles;
}

/// `heading`, or that of an end which it equals but for rounding: else an arc of nothing could come out as a
/// full turn. The arcs still add up to the heading of the end, and the straight moves by rounding only.
/// (Three turns need no such care: with an arc of nothing they are two turns that touch, which LSR and RSL
/// find.)
double snapped(double heading, const Circles& circles) noexcept {
  const double slack = kRounding + circles.noise / std::max(circles.distance, kShortestSegment);
  for (const double end : {circles.heading_from, circles.heading_to}) {
    if (std::abs(wrapCourse(heading - end)) <= slack) return end;
  }
  return heading;
}

class PathBuilder {
 public:
  PathBuilder(DubinsWord word, double radius) noexcept : radius_(radius) { path_.word = word; }

  void addArc(const Eigen::Vector2d& centre, TurnDirection direction, double heading_in,
              double heading_out) noexcept {
    const double sweep = wrapPositive(sign(direction) * (heading_out - heading_in));
    const double start = wrapCourse(bearingAtHeading(heading_in, direction));
    add(ArcSegment{centre, radius_, direction, start, sweep}, radius_ * sweep);
  }

  void addLine(const Eigen::Vector2d& a, const Eigen::Vector2d& b) noexcept {
    add(LineSegment{a, b}, (b - a).norm());
  }

  const DubinsPath& path() const noexcept { return path_; }

 private:
  void add(const PathSegment& segment, double part_length) noexcept {
    if (part_length < kShortestSegment) return;
    path_.segments[static_cast<std::size_t>(path_.segment_count++)] = segment;
    path_.length += part_length;
  }

  double radius_;
  DubinsPath path_;
};

std::optional<DubinsPath> turnStraightTurn(DubinsWord word, const TurnWord& turns, const Circles& circles,
                                           double radius) noexcept {
  // The tangent of two circles of one sense runs parallel to the line between their centres, that of
  // circles of different senses crosses it.
  double heading = circles.bearing;
  if (turns.first != turns.last) {
    // Circles that just touch must not be lost to rounding: S-turns are among the shortest paths.
    if (circles.distance < 2.0 * radius - circles.noise) return std::nullopt;
    heading += sign(turns.first) * std::asin(std::min(1.0, 2.0 * radius / circles.distance));
  } else if (circles.distance < kShortestSegment) {
    heading = circles.heading_from;  // one circle
  }
  heading = snapped(heading, circles);
  PathBuilder builder(word, radius);
  builder.addArc(circles.first, turns.first, circles.heading_from, heading);
  builder.addLine(circles.first + radius * unit(bearingAtHeading(heading, turns.first)),
                  circles.last + radius * unit(bearingAtHeading(heading, turns.last)));
  builder.addArc(circles.last, turns.last, heading, circles.heading_to);
  return builder.path();
}

std::optional<DubinsPath> threeTurns(DubinsWord word, const TurnWord& turns, const Circles& circles,
                                     double radius) noexcept {
  if (circles.distance > 4.0 * radius) return std::nullopt;
  // The centres are the corners of an isosceles triangle with legs of 2 radii; on this side of the base the
  // middle arc is pi + 2 base_angle, on the other pi - 2 base_angle.
  const double base_angle = std::acos(circles.distance / (4.0 * radius));
  const double to_middle = circles.bearing + sign(turns.first) * base_angle;
  const double to_last = circles.bearing - sign(turns.first) * base_angle;
  const Eigen::Vector2d middle = circles.first + 2.0 * radius * unit(to_middle);
  // Circles touch on the line between their centres.
  const double heading_in = to_middle + sign(turns.first) * kPi / 2.0;
  const double heading_out = to_last - sign(turns.first) * kPi / 2.0;
  PathBuilder builder(word, radius);
  builder.addArc(circles.first, turns.first, circles.heading_from, heading_in);
  builder.addArc(middle, opposite(turns.first), heading_in, heading_out);
  builder.addArc(circles.last, turns.last, heading_out, circles.heading_to);
  return builder.path();
}

}  // namespace

const char* toString(DubinsWord word) noexcept {
  switch (word) {
    case DubinsWord::kLsl:
      return "LSL";
    case DubinsWord::kRsr:
      return "RSR";
    case DubinsWord::kLsr:
      return "LSR";
    case DubinsWord::kRsl:
      return "RSL";
    case DubinsWord::kRlr:
      return "RLR";
    case DubinsWord::kLrl:
      return "LRL";
  }
  return "?";
}

std::optional<DubinsPath> dubinsPath(DubinsWord word, const PathPose& from, const PathPose& to,
                                     double radius) noexcept {
  const TurnWord turns = turnsOf(word);
  const Circles circles = circlesOf(turns, from, to, radius);
  return turns.straight ? turnStraightTurn(word, turns, circles, radius)
                        : threeTurns(word, turns, circles, radius);
}

DubinsPath shortestDubinsPath(const PathPose& from, const PathPose& to, double radius) noexcept {
  std::optional<DubinsPath> shortest;
  for (const DubinsWord word : kDubinsWords) {
    std::optional<DubinsPath> path = dubinsPath(word, from, to, radius);
    if (path && (!shortest || path->length < shortest->length - kTie * (radius + shortest->length)))
      shortest = path;
  }
  return *shortest;  // LSL and RSR join any two poses
}

std::vector<PathSegment> planDubins(const std::vector<PathPose>& waypoints, double radius,
                                    const std::string& where) {
  if (waypoints.size() < 2)
    throw Error(where + ": waypoints: must be at least 2, got " + std::to_string(waypoints.size()));
  if (!std::isfinite(radius) || radius <= 0.0)
    throw Error(where + ": radius: must be positive, got " + std::to_string(radius));
  for (std::size_t i = 0; i < waypoints.size(); ++i) {
    if (!waypoints[i].position.allFinite() || !std::isfinite(waypoints[i].heading))
      throw Error(where + ": waypoints[" + std::to_string(i) + "]: must be finite");
  }
  std::vector<PathSegment> plan;
  for (std::size_t i = 1; i < waypoints.size(); ++i) {
    const DubinsPath path = shortestDubinsPath(waypoints[i - 1], waypoints[i], radius);
    plan.insert(plan.end(), path.segments.begin(), path.segments.begin() + path.segment_count);
  }
  return plan;
}

}  // namespace polyfly
