#pragma once

#include <array>
#include <cstddef>
#include <string>

#include "online_controller/types/options.hpp"
#include "region_maps/map_content.hpp"
#include "region_maps/region_map.hpp"
#include "validation/flight_log.hpp"
#include "validation/replay.hpp"

namespace polyfly {

/// A folder for one test, removed with all it holds.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  std::string operator/(const std::string& name) const { return path_ + "/" + name; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// A map made by hand for axis 0, 1 or 2: bounds so wide that none is ever active in the box, so that the law
/// is the unconstrained minimiser, computed here from the program's matrices. Two regions, parted where the
/// position error is 0, region 0 below.
MapContent handMadeMap(std::size_t axis);

/// The three maps in files of a folder, opened.
class HandMadeMaps {
 public:
  explicit HandMadeMaps(const ScratchFolder& folder);
  AxisMaps axes() const { return {&maps_[0], &maps_[1], &maps_[2]}; }
  const std::string& path(std::size_t axis) const { return maps_[axis].path(); }

 private:
  std::array<RegionMap, 3> maps_;
};

/// The flight of the tests: the vehicle is held at kHome with known errors, 100 samples each second.
struct SyntheticFlight {
  static constexpr std::size_t kSamples = 1000;
  static constexpr double kStart = 100.0;  ///< stamp of the first sample [s]
  static constexpr double kPeriod = 0.01;  ///< [s]
  static Eigen::Vector3d home() { return {1.0, -2.0, 3.0}; }
  /// Position minus home at a sample: a swing in the first half, then at rest.
  static Eigen::Vector3d error(std::size_t sample);
  /// Mean error of the second half.
  static Eigen::Vector3d restingError() { return {0.01, -0.02, 0.005}; }

  /// A sample of the odometry, `moved` from where it should be [m].
  static VehicleState state(std::size_t sample, const Eigen::Vector3d& moved = Eigen::Vector3d::Zero());
};

/// Answers odometry as the node does, without the replay's code, and records it.
class FlightRecorder {
 public:
  FlightRecorder(const AxisMaps& maps, const MultirotorOptions& options);
  ~FlightRecorder();
  FlightRecorder(const FlightRecorder&) = delete;
  FlightRecorder& operator=(const FlightRecorder&) = delete;

  /// Tracks the pose from now on.
  void hold(const Eigen::Vector3d& position);
  /// Flies one sample that the node answers.
  void fly(const VehicleState& state);
  /// Records one sample that never reached the node.
  void miss(const VehicleState& state);
  /// Records the watchdog's answer to silent odometry.
  void beSilent(double stamp);
  FlightLog& log() { return log_; }

 private:
  void record(double stamp);

  struct Node;
  Node* node_;
  FlightLog log_;
};

/// The whole flight, held from the first sample on.
FlightLog syntheticFlight(const AxisMaps& maps, const MultirotorOptions& options = {});

}  // namespace polyfly
