#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "bags/scan_bag.hpp"

namespace polyfly {

/// How much of a recording was read.
struct RecordingShare {
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
  /// The times that are lost, as far as the bag's end tells them, counted from the recording's begin.
  std::vector<TimeSpan> lost = {};

  /// Whether all three are known, and nothing is lost.
  bool isWhole() const;
};

/// Of two pieces of a recording, or of two recordings. `later` is how much the second begins after the first [s].
RecordingShare together(const RecordingShare& one, const RecordingShare& other, double later = 0.0);

/// The recordings that files of these times are, each as the numbers of its pieces in order of time. A piece begins
/// within a second of the end of the one before, as those of `rosbag record --split`.
std::vector<std::vector<std::size_t>> recordingsOf(const std::vector<TimeSpan>& files);

/// Of a bag that was read. Messages are those of the given topics, or all if there are none.
RecordingShare recordingShare(const BagHealth& health, const std::set<std::string>& topics = {});

/// "21.5 % of the messages (645 of 3001); 22 % of the bytes (...); 21.6 % of the seconds (...)". The share is never
/// rounded up to 100.
std::string describe(const RecordingShare& share);

/// "1.25 to 3 s, 5 to 6 s and 2 more times". Of many the first ones.
std::string describe(const std::vector<TimeSpan>& spans);

/// Why the recording is not whole, as a sentence. Empty if it is.
std::string lossSentence(const RecordingShare& share);

}  // namespace polyfly
