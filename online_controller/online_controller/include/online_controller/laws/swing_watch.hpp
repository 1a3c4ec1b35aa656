#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "online_controller/types/attitude.hpp"

namespace polyfly {

/// Notices commands of tilt that swing to and fro by more than the reference needs, as of feedback that is too quick for
/// the attitude loops. They swing while they have changed the side four times within 3 s. A side is reached where the
/// command is beyond the need by 0.6 of its bound.
class SwingWatch {
 public:
  /// What was commanded at `stamp` [s] and what the reference needs, along the axes of the world; `bound` of the commands
  /// [rad]. Whether they swing.
  bool notice(double stamp, const TiltAngles& commanded, const TiltAngles& needed, double bound) noexcept;

 private:
  static constexpr std::size_t kChanges = 4;
  static constexpr double kNever = -std::numeric_limits<double>::infinity();

  /// One axis of the world.
  struct Side {
    // -1 or 1; 0 before one was reached.
    int side = 0;
    // Stamps of the last changes; the next one replaces the oldest [s].
    std::array<double, kChanges> changes{kNever, kNever, kNever, kNever};
    std::size_t oldest = 0;

    bool swings(double stamp, double share) noexcept;
  };

  Side roll_, pitch_;
};

}  // namespace polyfly
