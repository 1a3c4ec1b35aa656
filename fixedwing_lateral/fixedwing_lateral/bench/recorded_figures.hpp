#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

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

/// The rows of a CSV file below its heading.
using Rows = std::vector<std::vector<double>>;

/// At least three columns and two rows of finite numbers; throws Error naming the file.
Rows readCsv(const std::string& path);

/// Time from which a loiter counts as settled; the recordings last 50 s [s].
constexpr double kLoiterSettled = 25.0;

struct Spread {
  double rms = 0.0;
  double largest = 0.0;
};

/// Distance from the circle about the origin after the settling time; columns: time, north, east.
Spread spreadOf(const Rows& rows, double radius);

}  // namespace polyfly
