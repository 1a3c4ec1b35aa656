#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>

#include "bags/scan_bag.hpp"

namespace polyfly {

/// How much of a recording was read.
struct RecordingShare {
  /// Share of each amount that stands for the whole recording.
  static constexpr double kWhole = 0.95;

  struct Amount {
    double read = 0.0;
    /// Empty where the bag's end is missing, so that nobody knows.
    std::optional<double> recorded;

    /// 0..1; empty where it is not known.
    std::optional<double> share() const;
  };

  Amount messages;
  Amount bytes;
  Amount seconds;

  /// Whether all three are known, and at least kWhole.
  bool isWhole() const;
};

/// Of a bag that was read. Messages are those of the given topics, or all if there are none.
RecordingShare recordingShare(const BagHealth& health, const std::set<std::string>& topics = {});

/// "21.5 % of the messages (645 of 3001); 22 % of the bytes (...); 21.6 % of the seconds (...)". The share is never
/// rounded up to 100.
std::string describe(const RecordingShare& share);

/// Why the recording is not whole, as a sentence. Empty if it is.
std::string lossSentence(const RecordingShare& share);

}  // namespace polyfly
