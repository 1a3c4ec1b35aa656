#include "fixedwing_lateral/convergence.hpp"

#include <algorithm>
#include <cmath>

#include "fixedwing_lateral/model.hpp"

namespace polyfly {
namespace {

constexpr double kNoOffset = 1e300;
// Least ground speed for the offset and the time limit [m/s].
constexpr double kSlowest = 1.0;

}  // namespace

void ConvergenceWatch::restart() noexcept {
  best_ = kNoOffset;
  without_progress_ = 0.0;
}

void ConvergenceWatch::update(const TrackError& error, double ground_speed, double roll,
                              double elapsed) noexcept {
  const double speed = std::max(ground_speed, kSlowest);
  const double acceleration = kGravity * std::tan(roll);
  const double course = error.course_defined ? error.course : 0.0;
  const double offset = std::abs(error.track) + speed * speed / acceleration * (1.0 - std::cos(course));
  const double room = kNear * speed;
  is_near_ = offset <= room;
  const bool progress = is_near_ || offset < best_ - room;
  if (progress) best_ = offset;
  const double share = elapsed * acceleration / (2.0 * kPi * speed * kTurns);
  without_progress_ = progress ? 0.0 : without_progress_ + share;
  near_ = is_near_ ? near_ + share : 0.0;
}

}  // namespace polyfly
