#pragma once

#include <iosfwd>
#include <vector>

namespace polyfly_ros {

/// How long the ways from odometry to command took, each list in microseconds.
struct ProbeTimes {
  /// Time from publish(odometry) to the callback with the command.
  std::vector<double> latency;
  /// Time that publish(odometry) took.
  std::vector<double> held;
  /// Time from the controller's callback to where its command was published.
  std::vector<double> inside;
  /// Parts of `inside`.
  std::vector<double> input, step, publishing;
  /// Odometry messages without a command.
  int missed = 0;

  int count() const { return static_cast<int>(latency.size()) + missed; }

  /// Number of samples, missed ones, and percentiles of each list, as a JSON object.
  void write(std::ostream& file) const;
};

/// The alternating turns of two programs by one clock: `length` seconds of calm, then as many under load, and so on.
/// With 0 there are no turns: each program does its task all the time. How a turn begins belongs to neither: what the
/// one before set going is still under way.
class Turns {
 public:
  enum class Turn { kCalm, kLoaded, kChanging };

  explicit Turns(double length) : length_(length) {}

  /// Turn for the node that measures.
  Turn at(double wall_time) const;
  /// Whether the node that makes the load is to make it.
  bool loadedAt(double wall_time) const;
  bool alternate() const { return length_ > 0.0; }

 private:
  static constexpr double kSettling = 0.2;  // share of a turn

  double length_;
};

}  // namespace polyfly_ros
