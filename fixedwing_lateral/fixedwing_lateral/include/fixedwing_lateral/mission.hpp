#pragma once

#include <memory>
#include <string>
#include <vector>

#include "fixedwing_lateral/dubins.hpp"
#include "fixedwing_lateral/path.hpp"
#include "fixedwing_lateral/switch_gate.hpp"

namespace polyfly {

/// The circle that is flown when a mission ends.
struct LoiterOptions {
  double radius = 80.0;  ///< [m], > 0; at 14 m/s flyable in a wind of 7 m/s by 30 degrees of roll
  TurnDirection direction = TurnDirection::kRight;
};

/// Segments in order of flight; the last is a loiter.
struct Mission {
  std::vector<PathSegment> segments;
  /// Curves to which segments point, if the mission must own them.
  std::vector<std::shared_ptr<const PathCurve>> curves;
  /// Points that were left out, see missionThrough.
  int merged_points = 0;
};

/// The segments, with a loiter that begins where the last one ends, unless that is one already. Throws
/// polyfly::Error, beginning with `where` and the segment's number, on no segment, one that breaks a rule of
/// path.hpp, or a loiter before the end.
Mission makeMission(std::vector<PathSegment> segments, const LoiterOptions& loiter, const std::string& where);

/// Points of a path that are nearer to each other than this are one [m].
constexpr double kSamePoint = 0.1;

/// Lines from each point to the next, then the loiter. A point nearer than kSamePoint to the one before is left out.
Mission missionThrough(const std::vector<Eigen::Vector2d>& points, const LoiterOptions& loiter,
                       const std::string& where);

/// How the next segment goes on where this one ends.
struct Onward {
  bool joins = false;  ///< it begins there
  bool is_smooth = false;
  Eigen::Vector2d direction = Eigen::Vector2d::Zero();
};

Onward onwardOf(const PathSegment& segment, const PathSegment& next);

/// Where an aircraft is in its mission. Advances where the switch condition is met. Also where the end of a segment
/// was passed without meeting it (beside the acceptance radius, or in another direction). Also where an end was
/// missed twice: the aircraft came near it and left again. That happens where the segments do not join or cannot be
/// flown.
class MissionTrack {
 public:
  /// One gate for each segment.
  MissionTrack(Mission mission, const SwitchCriterion& criterion);
  /// A track with nothing to fly.
  MissionTrack() = default;

  bool empty() const noexcept { return mission_.segments.empty(); }
  int count() const noexcept { return static_cast<int>(mission_.segments.size()); }
  /// Index of the segment that is flown.
  int index() const noexcept { return index_; }
  bool isLoitering() const noexcept { return !empty() && index_ == count() - 1; }

  // Of a track that is not empty.
  const PathSegment& current() const noexcept { return mission_.segments[index_]; }
  const PathSegment& next() const noexcept { return mission_.segments[isLoitering() ? index_ : index_ + 1]; }
  const SwitchGate& gate() const noexcept { return gates_[index_]; }
  /// The segment that a horizon sees behind the gate. That is not the next one where it leads back or lies elsewhere:
  /// there is no corner to cut, and the horizon would avoid the switch condition.
  const PathSegment& shownNext() const noexcept { return is_next_shown_[index_] ? next() : current(); }
  const std::vector<PathSegment>& segments() const noexcept { return mission_.segments; }

  /// Of the corner at the end of the segment that is flown. Of a track that is not empty. Allocates nothing.
  void shapeCorner(const CornerShape& shape) noexcept { gates_[index_].shapeCorner(shape); }

  /// Factor of the radius within which an aircraft is close to an end, > 0: turns of a faster aircraft are wider.
  void setNearScale(double scale) noexcept { near_scale_ = scale; }

  /// Goes on by at most one segment; true where it did. Corners count by the rule of the criterion, or as published.
  /// Allocates nothing.
  bool advance(const Eigen::Vector2d& position, const Eigen::Vector2d& ground_velocity,
               bool as_published = false) noexcept;

 private:
  bool hasPassedEnd(const Eigen::Vector2d& position) noexcept;
  bool hasMissedEnd(const Eigen::Vector2d& position) noexcept;

  Mission mission_;
  std::vector<SwitchGate> gates_;
  std::vector<bool> is_next_shown_;
  int index_ = 0;
  // True when the last call had a position on the second half of the segment.
  bool near_end_ = false;
  double near_radius_ = 0.0;
  double near_scale_ = 1.0;
  // True while the aircraft is within the scaled near_radius_ of the segment's end.
  bool close_to_end_ = false;
  // Number of times that the segment's end was missed.
  int misses_ = 0;
};

}  // namespace polyfly
