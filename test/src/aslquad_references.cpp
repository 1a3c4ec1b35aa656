#include <algorithm>
#include <cmath>

#include "polyfly_test/aslquad_figures.hpp"

namespace polyfly_test {
namespace {

using Eigen::Vector3d;
using polyfly::Reference;

constexpr double kHeight = 1.0;       // [m]
constexpr double kHelixRadius = 0.6;  // [m]
constexpr double kHelixRate = 0.9;    // [rad/s]
constexpr double kHelixClimb = 0.02;  // per radian [m]
constexpr double kHelixTime = 34.0;   // [s]
constexpr double kSquareSide = 1.0;   // [m]
constexpr double kCornerPause = 1.0;  // [s]
constexpr double kSideTime = 0.25 * kSquareLap - kCornerPause;

/// A scalar of time with its derivatives.
struct Profile {
  double value = 0.0, first = 0.0, second = 0.0, third = 0.0;
};

/// From 0 to 1 as s goes there, with three derivatives that vanish at both ends; in s.
Profile rise(double s) {
  if (s <= 0.0) return {};
  if (s >= 1.0) return {1.0, 0.0, 0.0, 0.0};
  const double s2 = s * s, s3 = s2 * s, t = 1.0 - s;
  return {s3 * s * (35.0 - 84.0 * s + 70.0 * s2 - 20.0 * s3), 140.0 * s3 * t * t * t,
          420.0 * s2 * t * t * (1.0 - 2.0 * s), 840.0 * s * t * (1.0 - 5.0 * s + 5.0 * s2)};
}

/// Phase of the helix: its rate rises from zero as 10 s^3 - 15 s^4 + 6 s^5, then stays.
Profile helixPhase(double time) {
  const double s = std::clamp(time / kHelixJoined, 0.0, 1.0);
  const double s2 = s * s, s3 = s2 * s;
  const double share = 2.5 * s3 * s - 3.0 * s3 * s2 + s3 * s3;  // integral of the rate
  Profile phase;
  phase.value = kHelixRate * (kHelixJoined * share + std::max(0.0, time - kHelixJoined));
  phase.first = kHelixRate * (10.0 * s3 - 15.0 * s3 * s + 6.0 * s3 * s2);
  phase.second = kHelixRate / kHelixJoined * 30.0 * s2 * (1.0 - s) * (1.0 - s);
  phase.third = kHelixRate / (kHelixJoined * kHelixJoined) * 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s);
  return phase;
}

Reference helix(double time) {
  const Profile p = helixPhase(time);
  const Vector3d on(std::cos(p.value), std::sin(p.value), 0.0);
  const Vector3d across(-on.y(), on.x(), 0.0);
  const Vector3d up(0.0, 0.0, kHelixClimb);
  Reference reference;
  reference.position = kHelixRadius * on + kHelixClimb * p.value * Vector3d::UnitZ();
  reference.position.z() += kHeight;
  reference.velocity = p.first * (kHelixRadius * across + up);
  reference.acceleration = kHelixRadius * (p.second * across - p.first * p.first * on) + p.second * up;
  reference.jerk =
      kHelixRadius * ((p.third - p.first * p.first * p.first) * across - 3.0 * p.first * p.second * on) +
      p.third * up;
  return reference;
}

Reference square(double time) {
  static const Vector3d kCorners[] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  Reference reference;
  reference.position = {0.0, 0.0, kHeight};
  if (time < 0.0 || time >= kSquareLaps * kSquareLap) return reference;
  const double quarter = 0.25 * kSquareLap;
  const int side = static_cast<int>(time / quarter);
  const Profile p = rise((time - side * quarter) / kSideTime);
  const Vector3d from = kSquareSide * kCorners[side % 4];
  const Vector3d way = kSquareSide * kCorners[(side + 1) % 4] - from;
  reference.position += from + p.value * way;
  reference.velocity = p.first / kSideTime * way;
  reference.acceleration = p.second / (kSideTime * kSideTime) * way;
  reference.jerk = p.third / (kSideTime * kSideTime * kSideTime) * way;
  return reference;
}

Reference hold(const Vector3d& position) {
  Reference reference;
  reference.position = position;
  return reference;
}

}  // namespace

Reference figureReference(AslquadFigure figure, double time) {
  switch (figure) {
    case AslquadFigure::kHelix:
      return helix(time);
    case AslquadFigure::kHit:
      return hold({0.0, 0.0, kHeight});
    case AslquadFigure::kSquare:
      return square(time);
    case AslquadFigure::kStep:
      return hold({0.0, kStepLength, kHeight});
  }
  return {};
}

double figureDuration(AslquadFigure figure) {
  switch (figure) {
    case AslquadFigure::kHelix:
      return kHelixTime;
    case AslquadFigure::kHit:
      return 13.0;
    case AslquadFigure::kSquare:
      return kSquareLaps * kSquareLap;
    case AslquadFigure::kStep:
      return 10.0;
  }
  return 0.0;
}

const char* figureName(AslquadFigure figure) {
  constexpr std::array<const char*, 4> kNames{"helix", "hit", "square", "step"};
  return kNames[static_cast<std::size_t>(figure)];
}

const char* lawName(AslquadLaw law) {
  constexpr std::array<const char*, 4> kNames{"robust", "nominal", "lqr", "estimate"};
  return kNames[static_cast<std::size_t>(law)];
}

}  // namespace polyfly_test
