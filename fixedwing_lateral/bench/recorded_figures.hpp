#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace polyfly {

/// A log of a real aircraft and the part of it that is flown by its autopilot.
struct RecordedLog {
  std::string path;
  double begin = 0.0;  ///< [s]
  double end = 0.0;    ///< [s]
};

/// From "FILE,BEGIN,END". Throws polyfly::Error.
RecordedLog parseLog(const std::string& text);

struct ReplayedLog {
  /// Columns t, north, east, roll, asked, wind.
  std::string csv;
  /// Statistics of the replay.
  nlohmann::json metrics;
};

/// Replays the guidance over the log open loop.
ReplayedLog replayLog(const RecordedLog& log);

}  // namespace polyfly
