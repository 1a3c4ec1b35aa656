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
  std::string csv;         ///< t, north, east, roll, asked, wind
  nlohmann::json metrics;  ///< what there is to say of it
};

/// Replays the guidance over the log open loop.
ReplayedLog replayLog(const RecordedLog& log);

}  // namespace polyfly
