#pragma once

#include <mavros_msgs/State.h>

#include <string>
#include <vector>

namespace polyfly_ros {

/// Whether the autopilot follows us, from its state: connected, armed, in one of the modes in which it takes
/// set-points, and not silent.
class AutopilotWatch {
 public:
  /// `modes`: names separated by commas, such as "OFFBOARD,GUIDED". Throws polyfly::Error naming `key` where
  /// there is none.
  AutopilotWatch(const std::string& modes, const std::string& key);

  void take(const mavros_msgs::State& state) { state_ = state; }
  bool follows(double now) const noexcept;  ///< `now` [s]

  /// In words, for diagnostics.
  std::string text(double now) const;

 private:
  bool isRecent(double now) const noexcept;
  bool isOurMode() const noexcept;

  std::vector<std::string> modes_;
  mavros_msgs::State state_;
};

}  // namespace polyfly_ros
