#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace polyfly {

/// The messages of one kind, as numbers in columns.
struct LogTable {
  /// Time of each row, by the autopilot's clock [s].
  std::vector<double> time;
  /// Values by field name. The entries of an array have names such as `q[0]` and `q[1]`.
  std::map<std::string, std::vector<double>> column;

  bool has(const std::string& field) const { return column.count(field) > 0; }
};

/// What an autopilot wrote to its own log.
struct AutopilotLog {
  enum class Kind { kULog, kDataflash };

  Kind kind = Kind::kULog;
  std::string path;
  /// By the message's name. Further instances (a second accelerometer) as `sensor_accel[1]`, `IMU[1]`.
  std::map<std::string, LogTable> tables;
  std::map<std::string, std::size_t> counts;  ///< rows of every message of the log, also of those not kept
  bool lossy = false;                         ///< parts of the record are lost
  std::vector<std::string> remarks;           ///< sentences: cut off, skipped, damaged, lost while logging
};

/// Whether the first bytes are those of such a log.
bool isULog(const std::string& path);
bool isDataflash(const std::string& path);

/// Reads a PX4 log (ULog, version 0 and 1; docs.px4.io) or an ArduPilot dataflash log (.bin; its FMT messages
/// describe the others). Only tables whose name without instance is in `wanted` are kept, all if it is empty. The
/// file is read once in pieces and not changed. What cannot be read is left out and told in remarks: a message that
/// was cut off, or one of an unknown or damaged format. Behind damage the next message is searched for. In a ULog a
/// message counts where its size and content are those of its type, and another one follows it or the file ends. Throws
/// Error naming file and rule: missing, empty, another format, a ULog that needs features that are unknown, no
/// message at all.
AutopilotLog readULog(const std::string& path, const std::vector<std::string>& wanted = {});
AutopilotLog readDataflash(const std::string& path, const std::vector<std::string>& wanted = {});

}  // namespace polyfly
