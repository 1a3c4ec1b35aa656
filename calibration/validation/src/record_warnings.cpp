#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "bags/recording_share.hpp"
#include "identification/header_clock.hpp"
#include "validation_parts.hpp"

namespace polyfly {
namespace {

// Greatest share of a record that may be missing without a warning.
constexpr double kMissing = 1.0 - RecordingShare::kWhole;
// Longest time between a command and later odometry in which the controller counts as running [s].
constexpr double kLongestPause = 1.0;

void warnOfLoss(const FlightLog& log, std::vector<std::string>* warnings) {
  if (!log.share) return;
  const std::string sentence = lossSentence(*log.share);
  if (!sentence.empty()) warnings->push_back(sentence);
}

void warnOfStamps(const FlightLog& log, std::vector<std::string>* warnings) {
  for (const FlightLog::TopicClock& topic : log.clocks) {
    std::string text;
    for (const std::string& clause : clausesOn(topic.clock, topic.start))
      text += (text.empty() ? "Topic " + topic.topic + ": " : "; ") + clause;
    if (!text.empty()) warnings->push_back(text + ". The replay uses the stamps of the headers.");
  }
}

void warnOfUnmatched(const CommandValidation& commands, std::vector<std::string>* warnings) {
  if (static_cast<double>(commands.unmatched) <= kMissing * static_cast<double>(commands.recorded)) return;
  warnings->push_back(
      std::to_string(commands.unmatched) + " of " + std::to_string(commands.recorded) +
      " recorded commands answer no recorded odometry and are not compared: odometry is lost, or the "
      "stamps of both are of different clocks.");
}

void warnOfStretches(const FlightLog& log, const ValidationReport& report,
                     std::vector<std::string>* warnings) {
  for (const IncomparableStretch& stretch : report.incomparable) {
    const double start = log.odometry.front().stamp;
    std::array<char, 320> text{};
    std::snprintf(
        text.data(), text.size(),
        "At %.6g s the controller's status tells of another position or velocity than the recorded odometry: "
        "the "
        "recording is altered. %zu commands are not compared, until both agree again at %.6g s.",
        stretch.from - start, stretch.samples, stretch.to - start);
    warnings->push_back(text.data());
  }
}

// Odometry that came before the first command does not count: recorders are started before controllers.
void warnOfSilence(const FlightLog& log, std::vector<std::string>* warnings) {
  std::vector<double> commands;
  for (const FlightLog::Command& command : log.commands) {
    if (std::isfinite(command.stamp)) commands.push_back(command.stamp);
  }
  std::sort(commands.begin(), commands.end());
  std::size_t judged = 0, silent = 0;
  double first = 0.0;
  for (const VehicleState& state : log.odometry) {
    const auto later = std::upper_bound(commands.begin(), commands.end(), state.stamp);
    if (later == commands.begin()) continue;
    ++judged;
    if (state.stamp - later[-1] <= kLongestPause) continue;
    if (silent++ == 0) first = state.stamp - log.odometry.front().stamp;
  }
  if (static_cast<double>(silent) <= kMissing * static_cast<double>(judged)) return;
  std::array<char, 240> text{};
  std::snprintf(
      text.data(), text.size(),
      "%.3g %% of the odometry behind the first command came more than %g s after the last command, first at "
      "%.4g s: the controller stopped, or its commands are lost. These parts are not judged.",
      100.0 * static_cast<double>(silent) / static_cast<double>(judged), kLongestPause, first);
  warnings->push_back(text.data());
}

}  // namespace

std::vector<std::string> recordWarnings(const FlightLog& log, const ValidationReport& report) {
  std::vector<std::string> warnings;
  warnOfLoss(log, &warnings);
  warnOfStamps(log, &warnings);
  warnOfUnmatched(report.commands, &warnings);
  warnOfStretches(log, report, &warnings);
  warnOfSilence(log, &warnings);
  return warnings;
}

}  // namespace polyfly
