#pragma once

#include <std_msgs/Header.h>

#include <array>
#include <cstddef>
#include <cstdint>

#include "online_controller/laws/law_switch.hpp"
#include "online_controller/types/types.hpp"

namespace polyfly_ros {

/// How long the stages of one control period took [ns].
struct StageTimes {
  /// Message to state, with references looked up.
  std::int64_t input = 0;
  /// Step of the law.
  std::int64_t step = 0;
  /// Command to message, published.
  std::int64_t output = 0;
  /// Status published, laws exchanged, next step prepared.
  std::int64_t prepare = 0;

  std::int64_t latency() const noexcept { return input + step + output; }
  std::int64_t whole() const noexcept { return latency() + prepare; }
};

/// One command, or the decision to send none, as it is reported after it was sent.
struct Answered {
  /// Header of the command.
  std_msgs::Header header;
  polyfly::Law law{};
  polyfly::ControlReport report;
  /// True when the command of the report was sent.
  bool sends = false;
  StageTimes times;
  double odometry_age = 0.0;  ///< [s]
  /// Number of commands before this one, set by AnsweredList.
  std::uint32_t sequence = 0;

  /// True: in answer to odometry. False: in its silence, or by the sticks.
  bool by_odometry = false;
  /// Odometry; valid only with `by_odometry`, like the next two members.
  polyfly::VehicleState state;
  /// True when the odometry was good enough to be flown on.
  bool accepted = false;
  /// Value of FlightSupervisor::restarted().
  bool restarted = false;
};

/// Commands that were sent and are not reported yet. When it is full the last one is replaced, which a gap in the
/// sequence shows. Allocates only where a frame's name is longer than those before.
class AnsweredList {
 public:
  /// The next one; the caller fills all but its sequence.
  Answered& add() noexcept {
    if (count_ < entries_.size()) ++count_;
    Answered& entry = entries_[count_ - 1];
    entry.sequence = sequence_++;
    return entry;
  }
  void clear() noexcept { count_ = 0; }

  bool empty() const noexcept { return count_ == 0; }
  const Answered& last() const noexcept { return entries_[count_ - 1]; }
  const Answered* begin() const noexcept { return entries_.data(); }
  const Answered* end() const noexcept { return entries_.data() + count_; }

 private:
  std::array<Answered, 8> entries_;
  std::size_t count_ = 0;
  std::uint32_t sequence_ = 0;
};

}  // namespace polyfly_ros
