#include "fixedwing_lateral/turn_limits.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

using Eigen::Vector2d;

constexpr double kDegree = 180.0 / kPi;
// Tolerance of a roll for which a radius was planned [rad].
constexpr double kRounding = 1e-9;
// Relative tolerance of a deviation for which a radius was planned.
constexpr double kRelativeRounding = 1e-6;
// Factor of the least radius from which a presumed roll rate is told of.
constexpr double kTellingWidth = 1.2;
// Greatest distance from the end of a segment to the one after it, for a smooth junction [m].
constexpr double kMeets = 1.0;
// Presumed roll rate, 17 deg/s, and the airspeed up to which it holds.
constexpr double kPresumedRate = 0.3;       // [rad/s]
constexpr double kPresumedAirspeed = 14.0;  // [m/s]
// Least cosine of the angle between the directions of the two segments there.
constexpr double kMeetsCosine = 0.995;

/// Of the segment [1/m], without its sign.
double largestCurvature(const PathSegment& segment) {
  if (std::holds_alternative<LineSegment>(segment)) return 0.0;
  if (const auto* arc = std::get_if<ArcSegment>(&segment)) return 1.0 / arc->radius;
  if (const auto* circle = std::get_if<LoiterCircle>(&segment)) return 1.0 / circle->radius;
  constexpr int kPoints = 500;
  double largest = 0.0;
  for (int i = 0; i <= kPoints; ++i) {
    const PathPoint point = pointAt(segment, length(segment) * i / kPoints);
    largest = std::max(largest, std::abs(closestPoint(segment, point.position).curvature));
  }
  return largest;
}

/// With the speed and the crab angle of a flight along the course. Upwind there may be no such flight: the
/// ground speed is 0 then, and no roll is asked for.
double rollAlongCourse(double curvature, double course, const LateralConditions& conditions) noexcept {
  const Vector2d along(std::cos(course), std::sin(course));
  const double with = conditions.wind.dot(along);
  const double across =
      (conditions.wind.y() * along.x() - conditions.wind.x() * along.y()) / conditions.airspeed;
  if (std::abs(across) >= 1.0) return kPi / 2.0;
  const double cosine = std::sqrt(1.0 - across * across);
  return rollOfTurn(curvature, std::max(0.0, conditions.airspeed * cosine + with), cosine, conditions);
}

/// Of the courses of an arc the one nearest to the direction that the wind blows to [rad].
double courseNearestDownwind(const ArcSegment& arc, const Vector2d& wind) noexcept {
  const double turn = arc.direction == TurnDirection::kRight ? 1.0 : -1.0;
  const double middle = arc.start_bearing + turn * (0.5 * arc.sweep + kPi / 2.0);
  const double off = wrapCourse(std::atan2(wind.y(), wind.x()) - middle);
  return middle + std::clamp(off, -0.5 * arc.sweep, 0.5 * arc.sweep);
}

std::string format(const char* pattern, double one, double two, double three, double four) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, one, two, three, four);
  return text;
}

/// With its sign: right turns are positive [1/m].
double curvatureAt(const PathSegment& segment, double along) {
  return closestOnCarrier(segment, pointAt(segment, along).position).curvature;
}

/// The roll for a curvature with the wind from the worst direction [rad].
double rollOfCurvature(double curvature, const TurnConditions& conditions) noexcept {
  if (curvature == 0.0) return 0.0;
  const double fastest = conditions.airspeed + conditions.wind_speed;
  const double turning = fastest * fastest * std::abs(curvature) + conditions.airspeed * conditions.turn_bias;
  return std::copysign(std::atan(turning / (kGravity * conditions.turn_gain)), curvature);
}

bool isSmooth(const PathSegment& segment, const PathSegment& next) {
  const PathPoint end = pointAt(segment, length(segment));
  const PathPoint met = closestOnCarrier(next, end.position).point;
  return (met.position - end.position).norm() < kMeets && met.tangent.dot(end.tangent) > kMeetsCosine;
}

LoiterCircle widened(const LoiterCircle& circle, double radius, const PathSegment* before) {
  LoiterCircle wide{circle.centre, radius, circle.direction};
  if (before == nullptr) return wide;
  const PathPoint met = closestPoint(circle, pointAt(*before, length(*before)).position).point;
  if (isSmooth(*before, circle))
    wide.centre = met.position + radius / circle.radius * (circle.centre - met.position);
  return wide;
}

}  // namespace

void checkTurns(const TurnConditions& conditions, const std::string& where) {
  const auto check = [&](const char* name, double value, bool holds, const char* rule) {
    if (!holds || !std::isfinite(value))
      throw Error(where + ": " + name + ": must " + rule + ", got " + std::to_string(value));
  };
  check("airspeed", conditions.airspeed, conditions.airspeed > 0.0, "be positive");
  check("wind", conditions.wind_speed,
        conditions.wind_speed >= 0.0 && conditions.wind_speed < conditions.airspeed,
        "be at least 0 and below the airspeed");
  check("roll", conditions.roll, conditions.roll > 0.0 && conditions.roll < kPi / 2.0,
        "lie between 0 and pi/2");
  check("turn_gain", conditions.turn_gain, conditions.turn_gain > 0.0, "be positive");
  check("turn_bias", conditions.turn_bias, conditions.turn_bias >= 0.0, "be at least 0");
  check("roll_rate", conditions.roll_rate, conditions.roll_rate >= 0.0, "be at least 0");
  check("roll_variance", conditions.roll_variance, conditions.roll_variance >= 0.0, "be at least 0");
  check("deviation", conditions.deviation, conditions.deviation >= 0.0, "be at least 0");
}

double presumedRollRate(double airspeed) noexcept {
  return kPresumedRate * std::min(1.0, kPresumedAirspeed / airspeed);
}

double rollVariance(const LateralModel& model) noexcept {
  const double delay = model.a1 / model.a0;
  return std::max(0.0, delay * delay - 2.0 / model.a0);
}

double deviationOf(double from, double to, const TurnConditions& conditions) noexcept {
  const double jump = kGravity * conditions.turn_gain * std::abs(std::tan(to) - std::tan(from));
  double variance = conditions.roll_variance;
  if (conditions.roll_rate > 0.0) {
    const double ramp = (to - from) / conditions.roll_rate;
    variance += ramp * ramp / 12.0;
  }
  return 0.5 * jump * variance;
}

double plannedRoll(const TurnConditions& conditions) noexcept {
  const auto isWithin = [&](double roll) {
    return deviationOf(-roll, roll, conditions) <= conditions.deviation;
  };
  if (!(conditions.deviation > 0.0) || isWithin(conditions.roll)) return conditions.roll;
  double within = 0.0;
  double beyond = conditions.roll;
  while (beyond - within > kRounding) {
    const double middle = 0.5 * (within + beyond);
    (isWithin(middle) ? within : beyond) = middle;
  }
  return within;
}

double leastRadius(const TurnConditions& conditions) noexcept {
  if (!(conditions.wind_speed < conditions.airspeed)) return std::numeric_limits<double>::infinity();
  const double fastest = conditions.airspeed + conditions.wind_speed;
  const double turning = kGravity * conditions.turn_gain * std::tan(plannedRoll(conditions)) -
                         conditions.airspeed * conditions.turn_bias;
  return turning > 0.0 ? fastest * fastest / turning : std::numeric_limits<double>::infinity();
}

double steepestRoll(const PathSegment& segment, const TurnConditions& conditions) {
  const double curvature = largestCurvature(segment);
  if (curvature == 0.0) return 0.0;
  if (!(conditions.wind_speed < conditions.airspeed)) return kPi / 2.0;
  return rollOfCurvature(curvature, conditions);
}

double steepestRoll(const PathSegment& segment, const Vector2d& position,
                    const LateralConditions& conditions) noexcept {
  if (std::holds_alternative<LineSegment>(segment)) return 0.0;
  const double downwind = std::atan2(conditions.wind.y(), conditions.wind.x());
  double curvature = 0.0;
  double course = downwind;
  if (const auto* arc = std::get_if<ArcSegment>(&segment)) {
    curvature = (arc->direction == TurnDirection::kRight ? 1.0 : -1.0) / arc->radius;
    course = courseNearestDownwind(*arc, conditions.wind);
  } else if (const auto* circle = std::get_if<LoiterCircle>(&segment)) {
    curvature = (circle->direction == TurnDirection::kRight ? 1.0 : -1.0) / circle->radius;
  } else {
    const ClosestPoint nearest = closestPoint(segment, position);
    curvature = nearest.curvature;
    course = std::atan2(nearest.point.tangent.y(), nearest.point.tangent.x());
  }
  if (curvature == 0.0) return 0.0;
  return std::abs(rollAlongCourse(curvature, course, conditions));
}

std::vector<SteepSegment> steepSegments(const std::vector<PathSegment>& segments,
                                        const TurnConditions& conditions) {
  std::vector<SteepSegment> steep;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    const double roll = steepestRoll(segments[i], conditions);
    if (roll > conditions.roll + kRounding) steep.push_back({static_cast<int>(i), roll});
  }
  return steep;
}

std::vector<AbruptJunction> abruptJunctions(const std::vector<PathSegment>& segments,
                                            const TurnConditions& conditions) {
  std::vector<AbruptJunction> abrupt;
  if (!(conditions.deviation > 0.0)) return abrupt;
  for (std::size_t i = 0; i + 1 < segments.size(); ++i) {
    if (!isSmooth(segments[i], segments[i + 1])) continue;
    const double before = rollOfCurvature(curvatureAt(segments[i], length(segments[i])), conditions);
    const double after = rollOfCurvature(curvatureAt(segments[i + 1], 0.0), conditions);
    const double deviation = deviationOf(before, after, conditions);
    if (deviation > conditions.deviation * (1.0 + kRelativeRounding))
      abrupt.push_back({static_cast<int>(i), deviation});
  }
  return abrupt;
}

namespace {

std::string describeAbrupt(const std::vector<PathSegment>& segments, const TurnConditions& conditions) {
  const std::vector<AbruptJunction> abrupt = abruptJunctions(segments, conditions);
  if (abrupt.empty()) return {};
  const auto worst = *std::max_element(
      abrupt.begin(), abrupt.end(),
      [](const AbruptJunction& a, const AbruptJunction& b) { return a.deviation < b.deviation; });
  return "the roll cannot change as fast as the path behind segment " + std::to_string(worst.segment) +
         format(
             " asks for: it will be left by %.1f m, where %.1f are allowed; circles of %.1f m can be flown",
             worst.deviation, conditions.deviation, leastRadius(conditions), 0.0) +
         (conditions.is_rate_presumed ? format(" (%.0f deg/s presumed, as model/roll_rate_max is not set)",
                                               kDegree * conditions.roll_rate, 0.0, 0.0, 0.0)
                                      : std::string());
}

}  // namespace

std::string describeSteep(const std::vector<PathSegment>& segments, const TurnConditions& conditions) {
  const std::vector<SteepSegment> steep = steepSegments(segments, conditions);
  if (steep.empty()) return describeAbrupt(segments, conditions);
  const auto steepest =
      *std::max_element(steep.begin(), steep.end(),
                        [](const SteepSegment& a, const SteepSegment& b) { return a.roll < b.roll; });
  std::string others;
  if (steep.size() > 1) others = " (and " + std::to_string(steep.size() - 1) + " more too much)";
  return "segment " + std::to_string(steepest.segment) +
         format(" asks for %.1f degrees of roll", kDegree * steepest.roll, 0.0, 0.0, 0.0) + others +
         format(" where %.1f are allowed: at %.1f m/s in a wind of %.1f m/s circles need %.1f m",
                kDegree * conditions.roll, conditions.airspeed, conditions.wind_speed,
                leastRadius(conditions));
}

TightTurns tightTurnsOf(const std::string& name, const std::string& where) {
  if (name == "keep") return TightTurns::kKeep;
  if (name == "refuse") return TightTurns::kRefuse;
  if (name == "widen") return TightTurns::kWiden;
  throw Error(where + ": must be keep, refuse or widen, got '" + name + "'");
}

double TurnPlan::planned(double radius) const noexcept {
  return tight == TightTurns::kWiden ? std::max(radius, leastRadius(conditions)) : radius;
}

std::string describeWidening(const TurnPlan& plan) {
  if (plan.tight != TightTurns::kWiden || !plan.conditions.is_rate_presumed) return {};
  TurnConditions unbounded = plan.conditions;
  unbounded.roll_rate = 0.0;
  const double least = leastRadius(plan.conditions);
  if (least < kTellingWidth * leastRadius(unbounded)) return {};
  return format(
      "turns get a radius of at least %.0f m at %.1f m/s in a wind of %.1f m/s, because %.0f deg/s of roll "
      "are "
      "presumed; set model/roll_rate_max, a0, a1 and b0 of the aircraft for smaller ones",
      least, plan.conditions.airspeed, plan.conditions.wind_speed, kDegree * plan.conditions.roll_rate);
}

Mission fitTurns(Mission mission, const TurnPlan& plan, const std::string& where) {
  if (plan.tight == TightTurns::kKeep) return mission;
  if (plan.tight == TightTurns::kWiden && !mission.segments.empty()) {
    PathSegment& last = mission.segments.back();
    const auto* circle = std::get_if<LoiterCircle>(&last);
    const double least = leastRadius(plan.conditions);
    const PathSegment* before =
        mission.segments.size() > 1 ? &mission.segments[mission.segments.size() - 2] : nullptr;
    if (circle != nullptr && circle->radius < least) last = widened(*circle, least, before);
  }
  const std::string steep = describeSteep(mission.segments, plan.conditions);
  if (!steep.empty()) throw Error(where + ": " + steep);
  return mission;
}

}  // namespace polyfly
