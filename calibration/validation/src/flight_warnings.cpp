#include <algorithm>
#include <array>
#include <cmath>
#include <locale>
#include <map>
#include <sstream>

#include "identification/loop_record.hpp"
#include "online_controller/estimation/odometry_gate.hpp"
#include "validation_parts.hpp"

namespace polyfly {
namespace {

// Least root mean square position error for which another frame is suspected [m].
constexpr double kFrameError = 0.5;
// Greatest share of the position error that is left over in the frame that is meant.
constexpr double kFrameShare = 0.5;
// Greatest share of samples that may contradict themselves without a warning.
constexpr double kContradicting = 0.05;
// Least root mean square difference of commands that is worth a sentence [rad].
constexpr double kLeastAngle = 2e-3;
// Least difference of commands that is worth a sentence, relative to the commands.
constexpr double kLeastShare = 0.2;
// Greatest share of the command difference that is left over with sign or clock corrected.
constexpr double kExplains = 0.5;
// Longest shift of the clocks that is searched for [s].
constexpr double kLongestShift = 1.5;
// Least share of the samples at the greatest command that shows a limit.
constexpr double kAtLimit = 0.1;
// Greatest difference of two commands at one limit [rad].
constexpr double kSame = 1e-6;
constexpr std::array<const char*, 2> kAngles = {"roll", "pitch"};

using Angles = std::vector<double>;

double rms(const Angles& values) {
  double squares = 0.0;
  for (const double value : values) squares += value * value;
  return values.empty() ? 0.0 : std::sqrt(squares / static_cast<double>(values.size()));
}

// Of a[i + shift] - sign b[i], without its mean.
double spread(const Angles& a, const Angles& b, std::ptrdiff_t shift, double sign) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  const auto size = static_cast<std::ptrdiff_t>(a.size());
  for (std::ptrdiff_t i = std::max<std::ptrdiff_t>(0, -shift); i < std::min(size, size - shift); ++i) {
    const double difference = a[static_cast<std::size_t>(i + shift)] - sign * b[static_cast<std::size_t>(i)];
    sum += difference;
    squares += difference * difference;
    count += 1.0;
  }
  return std::sqrt(std::max(squares - sum * sum / count, 0.0) / count);
}

struct Pairs {
  std::vector<double> stamps;
  // Commands in the order of kAngles.
  std::array<Angles, 2> recorded;
  std::array<Angles, 2> replayed;
};

Pairs pairsOf(const FlightLog& log, const std::vector<ReplaySample>& samples) {
  std::map<double, const AttitudeCommand*> recorded;
  for (const FlightLog::Command& command : log.commands) recorded[command.stamp] = &command.command;
  Pairs pairs;
  for (const ReplaySample& sample : samples) {
    const auto match = recorded.find(sample.state.stamp);
    if (match == recorded.end()) continue;
    const AttitudeCommand& was = *match->second;
    const AttitudeCommand& is = sample.report.command;
    if (!std::isfinite(was.roll + was.pitch + is.roll + is.pitch)) continue;
    pairs.stamps.push_back(sample.state.stamp);
    pairs.recorded[0].push_back(was.roll);
    pairs.recorded[1].push_back(was.pitch);
    pairs.replayed[0].push_back(is.roll);
    pairs.replayed[1].push_back(is.pitch);
  }
  return pairs;
}

// Shift of the recorded commands against the replay's at which they agree best, in samples; 0 where none
// agrees much better.
std::ptrdiff_t clockShift(const Angles& recorded, const Angles& replayed, double period) {
  const double now = spread(recorded, replayed, 0, 1.0);
  const auto longest = std::min(static_cast<std::ptrdiff_t>(kLongestShift / period),
                                static_cast<std::ptrdiff_t>(recorded.size() / 4));
  std::ptrdiff_t best = 0;
  double least = kExplains * now;
  for (std::ptrdiff_t shift = -longest; shift <= longest; ++shift) {
    const double left = spread(recorded, replayed, shift, 1.0);
    if (left < least) {
      least = left;
      best = shift;
    }
  }
  return best;
}

std::string commandWarning(const Pairs& pairs, std::size_t angle, double angle_max) {
  const Angles& recorded = pairs.recorded[angle];
  const Angles& replayed = pairs.replayed[angle];
  Angles difference = recorded;
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= replayed[i];
  if (rms(difference) < std::max(kLeastAngle, kLeastShare * rms(replayed))) return "";
  std::ostringstream text;
  text.imbue(std::locale::classic());
  text.precision(3);
  text << "The recorded " << kAngles[angle] << " commands ";
  if (spread(recorded, replayed, 0, -1.0) < kExplains * spread(recorded, replayed, 0, 1.0)) {
    text << "are those of the replay with the other sign: sign or frame (y left or right) of commands or "
            "odometry is "
            "wrong.";
    return text.str();
  }
  const double period = durationOf(pairs.stamps) / static_cast<double>(pairs.stamps.size() - 1);
  const std::ptrdiff_t shift = clockShift(recorded, replayed, period);
  if (shift != 0) {
    text << "come " << std::abs(static_cast<double>(shift)) * period << " s "
         << (shift > 0 ? "after" : "before")
         << " those of the replay: the stamps of commands and odometry are of different clocks.";
    return text.str();
  }
  double greatest = 0.0;
  for (const double value : recorded) greatest = std::max(greatest, std::abs(value));
  const auto at_limit = std::count_if(recorded.begin(), recorded.end(),
                                      [&](double value) { return std::abs(value) > greatest - kSame; });
  const double share = static_cast<double>(at_limit) / static_cast<double>(recorded.size());
  if (share > kAtLimit && greatest < angle_max - kSame) {
    text << "stop at " << greatest << " rad (" << 100.0 * share
         << " % of the samples), where the controller may give " << angle_max
         << ": something limits them, or they were given with other options.";
    return text.str();
  }
  text << "are not those that these maps give with these options: are --map and --options what flew?";
  return text.str();
}

void warnOfCommands(const FlightLog& log, const std::vector<ReplaySample>& samples,
                    const MultirotorOptions& options, std::vector<std::string>* warnings) {
  const Pairs pairs = pairsOf(log, samples);
  if (pairs.stamps.size() < 2 || !(durationOf(pairs.stamps) > 0.0)) return;
  for (std::size_t angle = 0; angle < kAngles.size(); ++angle) {
    const std::string sentence = commandWarning(pairs, angle, options.angle_max);
    if (!sentence.empty()) warnings->push_back(sentence);
  }
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

std::vector<std::string> flightWarnings(const ReplayedFlight& flight) {
  std::vector<ReplaySample> samples;
  for (const ReplaySample& sample : flight.samples) {
    if (!sample.ignorance) samples.push_back(sample);
  }
  std::vector<std::string> warnings;
  warnOfClock(flight.log, &warnings);
  warnOfFrames(samples, &warnings);
  warnOfTwist(samples, &warnings);
  warnOfCommands(flight.log, samples, flight.options, &warnings);
  return warnings;
}

}  // namespace polyfly
