#include "online_controller/laws/swing_watch.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

// Share of the commands' bound from which on a side is reached.
constexpr double kSideShare = 0.6;
// Time within which all changes lie [s].
constexpr double kWindow = 3.0;

}  // namespace

bool SwingWatch::notice(double stamp, const TiltAngles& commanded, const TiltAngles& needed,
                        double bound) noexcept {
  const auto share = [bound](double command, double need) {
    return (command - std::clamp(need, -bound, bound)) / bound;
  };
  const bool roll = roll_.swings(stamp, share(commanded.roll, needed.roll));
  const bool pitch = pitch_.swings(stamp, share(commanded.pitch, needed.pitch));
  return roll || pitch;
}

bool SwingWatch::Side::swings(double stamp, double share) noexcept {
  const int reached = share > 0.0 ? 1 : -1;
  if (std::abs(share) > kSideShare && reached != side) {
    if (side != 0) {
      changes[oldest] = stamp;
      oldest = (oldest + 1) % kChanges;
    }
    side = reached;
  }
  const double since = stamp - changes[oldest];
  return since >= 0.0 && since < kWindow;
}

}  // namespace polyfly
