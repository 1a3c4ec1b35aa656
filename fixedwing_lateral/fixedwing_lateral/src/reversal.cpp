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

}  // namespace polyfly
