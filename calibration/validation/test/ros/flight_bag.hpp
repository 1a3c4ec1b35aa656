#pragma once

#include <rosbag/bag.h>

#include <cstdint>
#include <string>

#include "validation/flight_log.hpp"

namespace polyfly_ros {

struct FlightBagOptions {
  std::string name_space = "/firefly";  ///< without a slash at the end
  rosbag::CompressionType compression = rosbag::compression::Uncompressed;
  double arrival_shift = 0.0;  ///< commands and status reach the recorder so much later than odometry [s]
  std::uint32_t chunk_threshold = 768 * 1024;  ///< bytes after which a chunk ends
  bool odometry = true;                        ///< which topics to write
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
