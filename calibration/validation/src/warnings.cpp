#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>

#include "identification/header_clock.hpp"
#include "identification/loop_record.hpp"
#include "online_controller/estimation/odometry_gate.hpp"
#include "validation_parts.hpp"

namespace polyfly {
namespace {

// Greatest share of a record that may be missing without a warning.
constexpr double kMissing = 0.05;
// Least pause of all topics that is told, where samples are not farther apart [s].
constexpr double kLeastMissing = 0.2;
// Longest time between a command and later odometry in which the controller counts as running [s].
constexpr double kLongestPause = 1.0;
// Least root mean square difference of commands that is worth a sentence [rad].
constexpr double kLeastAngle = 2e-3;
// The first ones of CommandValidation::difference.
constexpr std::array<const char*, 2> kAngles = {"roll", "pitch"};
// Least root mean square position error for which another frame is suspected [m].
constexpr double kFrameError = 0.5;
// Greatest share of the position error that is left over in the frame that is meant.
constexpr double kFrameShare = 0.5;
// Greatest share of samples that may contradict themselves without a warning.
constexpr double kContradicting = 0.05;
// How a sentence on commands that are not compared goes on, in the order of Ignorance.
constexpr const char* kReasons[] = {
    ", until they agree again. The recording begins in flight: what the controller knew before is not in it.",
    ", until they agree again. A part of the recording is missing there.",
    ", until they agree again. The controller's status tells of another position or velocity error there: "
    "the recording is "
    "altered, or holds a reference a sample too late or too early.",
    ". Another version flew: its parameters are looked up again, and what its estimators made of the "
    "odometry is not "
    "compared."};

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

void warnOfOtherCommands(const CommandValidation& commands, std::vector<std::string>* warnings) {
  for (std::size_t angle = 0; angle < kAngles.size(); ++angle) {
    if (!(commands.difference[angle].rms >= kLeastAngle)) continue;
    warnings->push_back(std::string("The recorded ") + kAngles[angle] +
                        " commands are not those that these maps give with these options: are --map and "
                        "--options what flew?");
  }
}

// Pauses in which no topic of the flight holds anything, in seconds after the first odometry. A silence that the node
// noticed is none.
std::vector<TimeSpan> missingTimes(const FlightLog& log) {
  std::set<double> stamps;
  TimeSeries odometry;
  for (const VehicleState& state : log.odometry) odometry.time.push_back(state.stamp);
  stamps.insert(odometry.time.begin(), odometry.time.end());
  for (const FlightLog::Command& command : log.commands) stamps.insert(command.stamp);
  for (const FlightLog::Status& status : log.statuses) stamps.insert(status.stamp);
  const std::set<double> noticed(log.silences.begin(), log.silences.end());
  const double longest = std::max(kLeastMissing, kGapPeriods * typicalPeriod(odometry, kLongestPeriod));
  std::vector<TimeSpan> missing;
  for (auto before = stamps.begin(); before != stamps.end(); ++before) {
    const auto next = std::next(before);
    if (next == stamps.end() || !(*next - *before > longest) || isFarStep(*before, *next)) continue;
    if (noticed.count(*before) > 0 || noticed.count(*next) > 0) continue;
    missing.push_back({*before - odometry.time.front(), *next - odometry.time.front()});
  }
  return missing;
}

void warnOfMissingTimes(const FlightLog& log, std::vector<std::string>* warnings) {
  if (log.odometry.empty()) return;
  const std::vector<TimeSpan> missing = missingTimes(log);
  if (missing.empty()) return;
  warnings->push_back("Nothing is recorded from " + describe(missing) +
                      " after the first odometry: parts of the recording are lost, or nothing ran.");
}

void warnOfStretches(const FlightLog& log, const ValidationReport& report,
                     std::vector<std::string>* warnings) {
  for (std::size_t cause = 0; cause < std::size(kReasons); ++cause) {
    std::vector<TimeSpan> spans;
    std::size_t samples = 0;
    for (const IncomparableStretch& stretch : report.incomparable) {
      if (static_cast<std::size_t>(stretch.cause) != cause) continue;
      const double start = log.odometry.front().stamp;
      spans.push_back({stretch.from - start, stretch.to - start});
      samples += stretch.samples;
    }
    if (!spans.empty())
      warnings->push_back(std::to_string(samples) + " commands are not compared, from " + describe(spans) +
                          " after the first odometry" + kReasons[cause]);
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
  warnings->push_back(number(100.0 * static_cast<double>(silent) / static_cast<double>(judged)) +
                      " % of the odometry behind the first command came more than " + number(kLongestPause) +
                      " s after the last command, first at " + number(first, 4) +
                      " s: the controller stopped, or its commands are lost. These parts are not judged.");
}

void warnOfClock(const FlightLog& log, std::vector<std::string>* warnings) {
  std::vector<double> stamps;
  for (const VehicleState& state : log.odometry) stamps.push_back(state.stamp);
  for (const std::string& sentence : sentencesOn(farSteps(stamps))) {
    warnings->push_back("Odometry: " + sentence + "; the flight is judged in pieces.");
  }
}

void warnOfFrames(const std::vector<ReplaySample>& samples, std::vector<std::string>* warnings) {
  double as_is = 0.0, turned = 0.0, count = 0.0;
  for (const ReplaySample& sample : samples) {
    if (!sample.has_reference || !sample.state.position.allFinite()) continue;
    const Eigen::Vector3d& p = sample.state.position;
    as_is += (p - sample.reference.position).squaredNorm();
    turned += (Eigen::Vector3d(p.y(), p.x(), -p.z()) - sample.reference.position).squaredNorm();
    count += 1.0;
  }
  if (count == 0.0 || std::sqrt(as_is / count) < kFrameError) return;
  if (std::sqrt(turned) > kFrameShare * std::sqrt(as_is)) return;
  warnings->push_back(
      "The odometry follows its reference with x and y exchanged and z turned: one of them is "
      "north-east-down, "
      "where east-north-up is meant. Nothing else here can be relied on.");
}

// As the node judges the odometry, and in its words.
void warnOfTwist(const std::vector<ReplaySample>& samples, std::vector<std::string>* warnings) {
  const auto contradicting = std::count_if(samples.begin(), samples.end(), [](const ReplaySample& sample) {
    return sample.report.reason == ControlReason::kContradiction;
  });
  if (static_cast<double>(contradicting) <= kContradicting * static_cast<double>(samples.size())) return;
  warnings->push_back("In " + std::to_string(contradicting) + " of " + std::to_string(samples.size()) +
                      " samples " + kContradictionSentence + ".");
}

}  // namespace

std::vector<std::string> warningsOf(const ReplayedFlight& flight, const AxisMaps& maps,
                                    const ValidationReport& report) {
  std::vector<ReplaySample> comparable;
  for (const ReplaySample& sample : flight.samples) {
    if (!sample.ignorance) comparable.push_back(sample);
  }
  std::vector<std::string> warnings;
  warnOfLoss(flight.log, &warnings);
  warnOfMissingTimes(flight.log, &warnings);
  warnOfStamps(flight.log, &warnings);
  warnOfUnmatched(report.commands, &warnings);
  warnOfOtherCommands(report.commands, &warnings);
  warnOfStretches(flight.log, report, &warnings);
  warnOfSilence(flight.log, &warnings);
  warnOfClock(flight.log, &warnings);
  warnOfFrames(comparable, &warnings);
  warnOfTwist(comparable, &warnings);
  if (!report.parameters) return warnings;
  for (const std::string& told : parameterWarnings(*report.parameters, maps, flight.options))
    warnings.push_back(told);
  return warnings;
}

}  // namespace polyfly
