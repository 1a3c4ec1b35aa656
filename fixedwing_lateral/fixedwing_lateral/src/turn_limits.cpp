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
// Presumed roll rate, 17 deg/s, and the airspeed up to which it holds.
constexpr double kPresumedRate = 0.3;       // [rad/s]
constexpr double kPresumedAirspeed = 14.0;  // [m/s]

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

std::string format(const char* pattern, double one, double two, double three, double four) {
  char text[200];
  std::snprintf(text, sizeof text, pattern, one, two, three, four);
  return text;
}

LoiterCircle widened(const LoiterCircle& circle, double radius, const PathSegment* before) {
  LoiterCircle wide{circle.centre, radius, circle.direction};
  if (before == nullptr) return wide;
  const PathPoint met = closestPoint(circle, pointAt(*before, length(*before)).position).point;
  if (onwardOf(*before, circle).is_smooth)
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
  const double fastest = conditions.airspeed + conditions.wind_speed;
  const double turning = fastest * fastest * curvature + conditions.airspeed * conditions.turn_bias;
  return std::atan(turning / (kGravity * conditions.turn_gain));
}

double steepestRoll(const PathSegment& segment, const Vector2d& position,
                    const LateralConditions& conditions) noexcept {
  const double curvature = closestOnCarrier(segment, position).curvature;
  if (curvature == 0.0) return 0.0;
  return std::abs(rollOfTurn(curvature, conditions.airspeed + conditions.wind.norm(), 1.0, conditions));
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

std::string describeSteep(const std::vector<PathSegment>& segments, const TurnConditions& conditions) {
  const std::vector<SteepSegment> steep = steepSegments(segments, conditions);
  if (steep.empty()) return {};
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
