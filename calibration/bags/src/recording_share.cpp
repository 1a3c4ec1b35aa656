#include "bags/recording_share.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace polyfly {
namespace {

// Longest time between two pieces of a recording [s].
constexpr double kLongestSplit = 1.0;

std::string text(const char* format, double value) {
  std::array<char, 64> out{};
  std::snprintf(out.data(), out.size(), format, value);
  return out.data();
}

// Rounded down: what is not whole never reads as 100 %.
std::string percent(double share) { return text("%.4g", std::floor(share * 1e3) / 10.0) + " %"; }

std::string describe(const RecordingShare::Amount& amount, const std::string& name, const char* format) {
  const std::string read = text(format, amount.read);
  const std::optional<double> share = amount.share();
  if (!share) return read + " " + name + ", of an unknown number";
  return percent(*share) + " of the " + name + " (" + read + " of " + text(format, *amount.recorded) + ")";
}

}  // namespace

std::optional<double> RecordingShare::Amount::share() const {
  if (!recorded) return std::nullopt;
  return *recorded > 0.0 ? std::min(read / *recorded, 1.0) : 1.0;
}

RecordingShare together(const RecordingShare& one, const RecordingShare& other, double later) {
  const auto sum = [](const RecordingShare::Amount& a, const RecordingShare::Amount& b) {
    RecordingShare::Amount result = {a.read + b.read, std::nullopt};
    if (a.recorded && b.recorded) result.recorded = *a.recorded + *b.recorded;
    return result;
  };
  RecordingShare result = {sum(one.messages, other.messages), sum(one.bytes, other.bytes),
                           sum(one.seconds, other.seconds), one.lost};
  for (const TimeSpan& span : other.lost) result.lost.push_back({span.from + later, span.to + later});
  return result;
}

std::vector<std::vector<std::size_t>> recordingsOf(const std::vector<TimeSpan>& files) {
  std::vector<std::size_t> order(files.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&files](std::size_t one, std::size_t other) {
    return files[one].from < files[other].from;
  });
  std::vector<std::vector<std::size_t>> recordings;
  for (const std::size_t file : order) {
    const auto before =
        std::find_if(recordings.begin(), recordings.end(), [&](const std::vector<std::size_t>& recording) {
          const TimeSpan& last = files[recording.back()];
          return files[file].to > last.to && std::abs(files[file].from - last.to) < kLongestSplit;
        });
    if (before == recordings.end()) {
      recordings.push_back({file});
    } else {
      before->push_back(file);
    }
  }
  // In the order in which the first pieces were named.
  std::sort(recordings.begin(), recordings.end());
  return recordings;
}

bool RecordingShare::isWhole() const {
  const auto whole = [](const Amount& amount) { return amount.share().value_or(0.0) >= 1.0; };
  return whole(messages) && whole(bytes) && whole(seconds);
}

RecordingShare recordingShare(const BagHealth& health, const std::set<std::string>& topics) {
  RecordingShare share;
  double recorded = 0.0;
  for (const auto& [topic, count] : health.topics) {
    if (!topics.empty() && topics.count(topic) == 0) continue;
    share.messages.read += static_cast<double>(count.read);
    recorded += static_cast<double>(count.recorded);
  }
  share.bytes = {static_cast<double>(health.bytes_read), static_cast<double>(health.bytes)};
  share.seconds.read = health.seconds_read;
  if (health.end_found) {
    share.messages.recorded = recorded;
    share.seconds.recorded = health.seconds;
  }
  double begin = health.first;
  for (const TimeSpan& span : health.lost) begin = std::min(begin, span.from);
  for (const TimeSpan& span : health.lost) share.lost.push_back({span.from - begin, span.to - begin});
  return share;
}

std::string describe(const RecordingShare& share) {
  return describe(share.messages, "messages", "%.0f") + "; " + describe(share.bytes, "bytes", "%.0f") + "; " +
         describe(share.seconds, "seconds", "%.1f");
}

std::string describe(const std::vector<TimeSpan>& spans) {
  constexpr std::size_t kMostTold = 5;
  std::string all;
  for (std::size_t i = 0; i < std::min(spans.size(), kMostTold); ++i)
    all += (i == 0 ? "" : ", ") + text("%.6g", spans[i].from) + " to " + text("%.6g", spans[i].to) + " s";
  if (spans.size() > kMostTold) all += " and " + std::to_string(spans.size() - kMostTold) + " more times";
  return all;
}

std::string lossSentence(const RecordingShare& share) {
  if (share.isWhole()) return "";
  const bool known = share.messages.recorded && share.seconds.recorded;
  return std::string(known ? "Parts of the recording are lost." : "The end of the recording is missing.") +
         " Read were " + describe(share) + "." +
         (share.lost.empty() ? "" : " Lost: " + describe(share.lost) + " after the recording's begin.");
}

}  // namespace polyfly
