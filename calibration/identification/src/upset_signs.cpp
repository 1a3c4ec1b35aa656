#include <algorithm>
#include <cmath>
#include <utility>

#include "flight_signs.hpp"
#include "polyfly_base/quantile.hpp"

namespace polyfly {
namespace {

constexpr double kEarthGravity = 9.8066;  // [m/s^2]
// Steps over which turning is summed up, and what was commanded before is looked at.
constexpr std::size_t kTurnSteps = 8;
constexpr std::size_t kCommandSteps = 30;
// Tilt that is no upset in any case, and tilt beyond a command from which on it is one [rad].
constexpr double kTiltAllowed = 1.0;
constexpr double kTiltBeyond = 0.7;
// Tilt from which on it is an upset where no command tells [rad].
constexpr double kTiltUncommanded = 1.5;
// Turning within kTurnSteps that is no upset in any case, what is allowed beyond the commanded range and a half of it,
// and what is allowed where no command tells [rad].
constexpr double kTurnAllowed = 2.0;
constexpr double kTurnBeyond = 1.2;
constexpr double kTurnRange = 1.5;
constexpr double kTurnUncommanded = 2.6;
// The same of the yaw rate [rad/s].
constexpr double kSpinBeyond = 4.0;
constexpr double kSpinFactor = 1.5;
constexpr double kSpinUncommanded = 8.0;
// Share of gravity below which the vehicle falls, and above which it was hit.
constexpr double kFallShare = 0.25;
constexpr double kHitShare = 5.0;
// Median of the specific force, as a share of gravity, of an accelerometer whose unit is m/s^2.
constexpr double kForceLeast = 0.6;
constexpr double kForceGreatest = 1.4;

double valueOr(const std::vector<double>& values, std::size_t i, double otherwise) {
  return values.empty() || !std::isfinite(values[i]) ? otherwise : values[i];
}

// NaN where the attitude is not known.
std::vector<double> tiltsOf(const FlightGrid& grid) {
  std::vector<double> tilts(grid.size, std::nan(""));
  for (std::size_t i = 0; i < grid.size && !grid.roll.empty() && !grid.pitch.empty(); ++i)
    tilts[i] = std::acos(std::clamp(std::cos(grid.roll[i]) * std::cos(grid.pitch[i]), -1.0, 1.0));
  return tilts;
}

// Greatest minus least of the last values up to i, and greatest size.
struct Recent {
  double range = 0.0;
  double greatest = 0.0;
};

Recent recentOf(const std::vector<double>& values, std::size_t i) {
  double least = 0.0;
  double most = 0.0;
  Recent recent;
  bool any = false;
  for (std::size_t k = i < kCommandSteps ? 0 : i - kCommandSteps; k <= i && !values.empty(); ++k) {
    if (!std::isfinite(values[k])) continue;
    least = any ? std::min(least, values[k]) : values[k];
    most = any ? std::max(most, values[k]) : values[k];
    any = true;
  }
  recent.range = most - least;
  recent.greatest = std::max(std::abs(least), std::abs(most));
  return recent;
}

// Angle by which the direction of gravity in the body's frame moves between two times of the grid.
double turnBetween(const FlightGrid& grid, std::size_t one, std::size_t other) {
  const auto down = [&grid](std::size_t i, double* xyz) {
    xyz[0] = -std::sin(grid.pitch[i]);
    xyz[1] = std::cos(grid.pitch[i]) * std::sin(grid.roll[i]);
    xyz[2] = std::cos(grid.pitch[i]) * std::cos(grid.roll[i]);
  };
  double a[3];
  double b[3];
  down(one, a);
  down(other, b);
  return std::acos(std::clamp(a[0] * b[0] + a[1] * b[1] + a[2] * b[2], -1.0, 1.0));
}

// Angle that the vehicle turned about horizontal axes since kTurnSteps, by attitude or gyro.
double turned(const FlightGrid& grid, std::size_t i) {
  double by_attitude = 0.0;
  double by_gyro = 0.0;
  for (std::size_t k = i - kTurnSteps; k < i; ++k) {
    if (!grid.roll.empty() && !grid.pitch.empty()) {
      const double turn = turnBetween(grid, k, k + 1);
      if (std::isfinite(turn)) by_attitude += turn;
    }
    by_gyro += kPhaseStep * std::hypot(valueOr(grid.gyro_x, k, 0.0), valueOr(grid.gyro_y, k, 0.0));
  }
  return std::max(by_attitude, by_gyro);
}

bool spins(const FlightGrid& grid, std::size_t i) {
  double mean = 0.0;
  for (std::size_t k = i - kTurnSteps; k < i; ++k) mean += valueOr(grid.yaw_rate, k, 0.0) / kTurnSteps;
  const double allowed = grid.yaw_rate_cmd.empty()
                             ? kSpinUncommanded
                             : kSpinBeyond + kSpinFactor * recentOf(grid.yaw_rate_cmd, i).greatest;
  return std::abs(mean) > allowed;
}

bool isCalibrated(std::vector<double> force) {
  force.erase(std::remove_if(force.begin(), force.end(), [](double one) { return !std::isfinite(one); }),
              force.end());
  const double middle = quantileOf(std::move(force));
  return middle > kForceLeast * kEarthGravity && middle < kForceGreatest * kEarthGravity;
}

bool falls(const FlightGrid& grid, std::size_t i) {
  for (std::size_t k = i - kTurnSteps; k <= i; ++k) {
    if (!(grid.force[k] < kFallShare * kEarthGravity)) return false;
  }
  return true;
}

bool isHit(const FlightGrid& grid, std::size_t i, bool calibrated) {
  if (calibrated && grid.force_peak[i] > kHitShare * kEarthGravity) return true;
  constexpr std::size_t kSteps = 2;
  if (grid.speed.empty() || i < kSteps) return false;
  const double change = std::abs(grid.speed[i] - grid.speed[i - kSteps]);
  return change > kHitShare * kEarthGravity * kSteps * kPhaseStep;
}

}  // namespace

UpsetSigns upsetSigns(const FlightGrid& grid) {
  UpsetSigns signs;
  signs.upset.assign(grid.size, false);
  signs.hit = signs.upset;
  const bool commanded = !grid.roll_cmd.empty() && !grid.pitch_cmd.empty();
  const std::vector<double> tilt = tiltsOf(grid);
  const bool calibrated = isCalibrated(grid.force);
  for (std::size_t i = 0; i < grid.size; ++i) {
    const Recent roll = recentOf(grid.roll_cmd, i);
    const Recent pitch = recentOf(grid.pitch_cmd, i);
    const double allowed =
        commanded ? std::max(kTiltAllowed, kTiltBeyond + std::hypot(roll.greatest, pitch.greatest))
                  : kTiltUncommanded;
    // A single sample is an outlier.
    const bool neighbour =
        (i > 0 && tilt[i - 1] > kTiltAllowed) || (i + 1 < grid.size && tilt[i + 1] > kTiltAllowed);
    signs.upset[i] = tilt[i] > allowed && neighbour;
    signs.hit[i] = isHit(grid, i, calibrated);
    if (i < kTurnSteps) continue;
    const double range = kTurnBeyond + kTurnRange * std::hypot(roll.range, pitch.range);
    const bool turns = turned(grid, i) > (commanded ? std::max(kTurnAllowed, range) : kTurnUncommanded);
    signs.upset[i] = signs.upset[i] || turns || spins(grid, i) || (calibrated && falls(grid, i));
  }
  return signs;
}

}  // namespace polyfly
