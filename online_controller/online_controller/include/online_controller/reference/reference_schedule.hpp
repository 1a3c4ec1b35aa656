#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "online_controller/reference/reference_excess.hpp"
#include "online_controller/reference/reference_trajectory.hpp"

namespace polyfly {

/// The trajectory in force and those that follow it. Times of a trajectory count from its start.
///
///     in force     o----o----o----o----o
///     new                    x----x----x----x        starts within it: replaces it from there on
///     flown        o----o----x----x----x----x
///
///     in force     o----o----o
///     new                      x----x----x           starts up to kJoin after its end: appended, the way
///     flown        o----o----o~x----x----x           between is interpolated
///
///     in force     o----o----o
///     new                             x----x         starts later: the last point is held until then
///     flown        o----o----o........x----x
///
/// What was to start at the new one's start or after it is dropped. A trajectory without a start takes over
/// with the next sample and drops all others.
class ReferenceSchedule {
 public:
  /// Greatest number of trajectories in force and waiting.
  static constexpr std::size_t kMaxEntries = 32;
  /// Longest gap that is interpolated [s].
  static constexpr double kJoin = 0.5;

  ReferenceSchedule();

  /// Takes over at time `start` [s], or with the next sample. The first of all is in force at once and holds
  /// its first pose until its start. An empty trajectory is ignored. Throws Error when too many wait.
  void set(ReferenceTrajectory trajectory, std::optional<double> start);

  /// Drops all.
  void clear() noexcept { first_ = count_ = 0; }

  /// The first point of all that asks for too much, see the function.
  ReferenceExcess findExcess(const Eigen::Vector3d& vehicle, const ReferenceLimits& limits) const noexcept;

  /// Holds a pose from now on and drops the rest. Does not allocate.
  void hold(const Eigen::Vector3d& position, double yaw) noexcept;

  /// Starts at `time` [s] what has no start of its own, and drops what is over. Does not allocate.
  void advance(double time) noexcept;

  /// Time began anew, `seconds` later: what a sample started goes on from where it was. Does not allocate.
  void shift(double seconds) noexcept;

  /// The reference at `time` [s], nothing before the first trajectory. Does not allocate.
  std::optional<Reference> sample(double time) noexcept;

  /// The references at `time` and at each `period` [s] after it, `count` of them; a trajectory that waits is
  /// seen in advance. False, and nothing is written, before the first trajectory. Does not allocate.
  bool preview(double time, double period, int count, Reference* references) noexcept;

  /// What is in force has come to its end or is a pose, and nothing waits.
  bool ended(double time) const noexcept;

 private:
  struct Entry {
    ReferenceTrajectory trajectory;
    std::optional<double> start;
    /// Whether a sample started it.
    bool by_sample = false;
    /// Time of the first point [s].
    double begin() const noexcept { return *start + trajectory.startTime(); }
  };

  Entry& active() noexcept { return entries_[first_]; }
  Entry& last() noexcept { return entries_[first_ + count_ - 1]; }
  void compact();

  std::array<Entry, kMaxEntries> entries_;
  // Entry in force; those before it are over.
  std::size_t first_ = 0;
  std::size_t count_ = 0;
};

}  // namespace polyfly
