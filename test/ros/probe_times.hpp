#pragma once

#include <iosfwd>
#include <vector>

namespace polyfly_ros {

/// How long the ways from odometry to command took, each list in microseconds.
struct ProbeTimes {
  std::vector<double> latency;  ///< from publish(odometry) to the callback with the command
  std::vector<double> held;     ///< how long publish(odometry) took
  std::vector<double> inside;   ///< from the controller's callback to where its command was published
  std::vector<double> input, step, publishing;  ///< of which
  int missed = 0;                               ///< odometries without a command

  int count() const { return static_cast<int>(latency.size()) + missed; }

  /// Number of samples, missed ones, and percentiles of each list, as a JSON object.
  void write(std::ostream& file) const;
};

/// The turns of two who share a clock: `length` seconds of calm, then as many under load, and so on; 0: each
/// does always what it is there for. How a turn begins belongs to neither: what the one before set going is
/// still under way.
class Turns {
 public:
  enum class Turn { kCalm, kLoaded, kChanging };

  explicit Turns(double length) : length_(length) {}

  Turn at(double wall_time) const;        ///< for who measures
  bool loadedAt(double wall_time) const;  ///< for who makes the load
  bool alternate() const { return length_ > 0.0; }

 private:
  static constexpr double kSettling = 0.2;  // share of a turn

  double length_;
};

}  // namespace polyfly_ros
