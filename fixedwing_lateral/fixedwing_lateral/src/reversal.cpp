#include "fixedwing_lateral/reversal.hpp"

#include <cmath>

namespace polyfly {
namespace {

using Eigen::Vector2d;

// Course error at which a side is chosen [rad].
constexpr double kBegins = 120.0 / 180.0 * kPi;
// Course error below which a side is no longer needed, also far from the path [rad].
constexpr double kEnds = 45.0 / 180.0 * kPi;
// Course error above which its sign is no reason for a side [rad].
constexpr double kDoubtful = 160.0 / 180.0 * kPi;
// Distance from the path above which the path's side counts [m].
constexpr double kBeside = 5.0;

/// Positive where `vector` points to the right of `direction`.
double toTheRight(const Vector2d& direction, const Vector2d& vector) noexcept {
  return direction.x() * vector.y() - direction.y() * vector.x();
}

Reversal sideOf(double right) noexcept { return right < 0.0 ? Reversal::kLeft : Reversal::kRight; }

/// How far from the line through `onward` the turn ends [m].
double endOfTurn(const PathPoint& onward, double course_error, Reversal side,
                 const SteadyTurn& turn) noexcept {
  const double angle = std::abs(courseError(course_error, side));
  const double radius = turn.airspeed * turn.airspeed / turn.acceleration;
  const double duration = angle * turn.airspeed / turn.acceleration;
  const Vector2d& along = turn.start.tangent;
  const Vector2d across = static_cast<double>(side) * Vector2d(-along.y(), along.x());
  const Vector2d stop = turn.start.position + radius * std::sin(angle) * along +
                        radius * (1.0 - std::cos(angle)) * across + duration * turn.wind;
  return std::abs(toTheRight(onward.tangent, stop - onward.position));
}

Reversal sideOf(const PathPoint& onward, const SteadyTurn& turn) noexcept {
  const double error = trackError(onward, turn.start.position, turn.start.tangent).course;
  if (!(std::abs(error) > kBegins)) return Reversal::kNone;
  const double right = endOfTurn(onward, error, Reversal::kRight, turn);
  const double left = endOfTurn(onward, error, Reversal::kLeft, turn);
  return left < right ? Reversal::kLeft : Reversal::kRight;
}

Reversal choose(double course_error, const Vector2d& direction, const Vector2d& to_path,
                const Vector2d& wind) noexcept {
  if (!(std::abs(course_error) > kBegins)) return Reversal::kNone;
  if (std::abs(course_error) < kDoubtful) return sideOf(course_error);
  const double beside = toTheRight(direction, to_path);
  return sideOf(std::abs(beside) > kBeside ? beside : -toTheRight(direction, wind));
}

}  // namespace

Reversal ReversalChoice::update(const TrackError& error, const Vector2d& to_path,
                                const Vector2d& ground_velocity, const Vector2d& wind) noexcept {
  if (!error.course_defined) return chosen_;
  if (chosen_ != Reversal::kNone && std::abs(courseError(error.course, chosen_)) < kEnds)
    chosen_ = Reversal::kNone;
  if (chosen_ == Reversal::kNone) chosen_ = choose(error.course, ground_velocity.normalized(), to_path, wind);
  return chosen_;
}

Junction junctionOf(const PathSegment& segment, const PathSegment& next, const SteadyTurn& turn,
                    double reach) noexcept {
  if (std::holds_alternative<LoiterCircle>(segment)) return {};
  const PathPoint end = pointAt(segment, length(segment));
  const PathPoint onward = closestOnCarrier(next, end.position).point;
  const Vector2d between = onward.position - end.position;
  const TrackError error = trackError(onward, end.position, end.tangent);
  if (!(std::abs(error.course) > kBegins)) return {Reversal::kNone, between.norm() <= reach};
  return {sideOf(onward, turn), false};
}

}  // namespace polyfly
