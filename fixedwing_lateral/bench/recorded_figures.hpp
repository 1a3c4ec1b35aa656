#pragma once

#include <filesystem>
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

/// Replays the guidance over the log open loop: log_NAME.csv in the folder (t, north, east, roll, asked,
/// wind), and what there is to say of it.
nlohmann::json replayLog(const RecordedLog& log, const std::filesystem::path& folder);

}  // namespace polyfly
