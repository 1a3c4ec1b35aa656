#include <algorithm>
#include <array>
#include <cmath>

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
constexpr std::array<const char*, 2> kAngles = {"roll", "pitch"};

// Sums over the samples that have both commands.
struct AngleSums {
  double count = 0.0;
  std::array<double, 2> difference{};
  std::array<double, 2> replayed{};
};

AngleSums anglesOf(const FlightLog& log, const std::vector<ReplaySample>& samples) {
  const auto recorded = log.commandsByStamp();
  AngleSums sums;
  for (const ReplaySample& sample : samples) {
    const auto match = recorded.find(sample.state.stamp);
    if (match == recorded.end()) continue;
    const AttitudeCommand& was = *match->second;
    const AttitudeCommand& is = sample.report.command;
    if (!std::isfinite(was.roll + was.pitch + is.roll + is.pitch)) continue;
    sums.count += 1.0;
    sums.difference[0] += (was.roll - is.roll) * (was.roll - is.roll);
    sums.difference[1] += (was.pitch - is.pitch) * (was.pitch - is.pitch);
    sums.replayed[0] += is.roll * is.roll;
    sums.replayed[1] += is.pitch * is.pitch;
  }
  return sums;
}

void warnOfCommands(const FlightLog& log, const std::vector<ReplaySample>& samples,
                    std::vector<std::string>* warnings) {
  const AngleSums sums = anglesOf(log, samples);
  if (sums.count < 2.0) return;
  for (std::size_t angle = 0; angle < kAngles.size(); ++angle) {
    const double difference = std::sqrt(sums.difference[angle] / sums.count);
    const double replayed = std::sqrt(sums.replayed[angle] / sums.count);
    if (difference < std::max(kLeastAngle, kLeastShare * replayed)) continue;
    warnings->push_back(std::string("The recorded ") + kAngles[angle] +
                        " commands are not those that these maps give with these options: are --map and "
                        "--options what flew?");
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
  warnOfCommands(flight.log, samples, &warnings);
  return warnings;
}

}  // namespace polyfly
