#pragma once

#include <rosbag/bag.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "validation/flight_log.hpp"

namespace polyfly_ros {

struct FlightBagOptions {
  /// Namespace without a slash at the end.
  std::string name_space = "/firefly";
  rosbag::CompressionType compression = rosbag::compression::Uncompressed;
  /// Delay of commands and status at the recorder, relative to odometry [s].
  double arrival_shift = 0.0;
  /// How late the recorder is from these times on [s], in order. Messages come in one after the other.
  std::vector<std::pair<double, double>> late;
  /// Bytes after which a chunk ends.
  std::uint32_t chunk_threshold = 20000;
  /// Whether to write odometry, references, commands and statuses.
  bool odometry = true;
  bool references = true;
  bool commands = true;
  bool statuses = true;
};

/// Writes a log as the recorder of a flight does; references must be poses.
void writeFlightBag(const polyfly::FlightLog& log, const std::string& path,
                    const FlightBagOptions& options = {});

/// Appends to an open bag.
void writeFlight(const polyfly::FlightLog& log, const FlightBagOptions& options, rosbag::Bag* bag);

}  // namespace polyfly_ros
