#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "difference_collector.hpp"
#include "online_controller/laws/axis.hpp"
#include "region_maps/region_map.hpp"
#include "validation_parts.hpp"

namespace polyfly {
namespace {

// Samples in a row whose commands agree until record and replay go together again.
constexpr std::size_t kAgreeing = 20;
// Greatest number of messages in a row that are altered where the record goes on behind them.
constexpr std::size_t kMostAltered = 10;
// Greatest difference of errors that the same odometry and reference lead to [m, m/s].
constexpr double kSameError = 1e-6;

// Greatest difference of two commands, thrust per mass; NaN if one is not finite.
double distance(const AttitudeCommand& one, const AttitudeCommand& other, double mass) {
  const double angle = worse(std::abs(one.roll - other.roll), std::abs(one.pitch - other.pitch));
  return worse(angle,
               worse(std::abs(one.yaw_rate - other.yaw_rate), std::abs(one.thrust - other.thrust) / mass));
}

// Whether the controller answered other errors of position or velocity than the record leads to.
bool answeredOther(const FlightLog::Status& status, const ControlReport& report, const AxisMaps& maps) {
  for (std::size_t axis = 0; axis < maps.size(); ++axis) {
    const AxisReport& replayed = report.axis[axis];
    if (status.theta[axis].size() != static_cast<std::size_t>(replayed.size)) return true;
    for (std::size_t index = 0; index < status.theta[axis].size(); ++index) {
      const std::string& name = maps[axis]->parameters()[index].name;
      if (name != kAxisNames[axis].position_error && name != kAxisNames[axis].velocity_error) continue;
      if (!(std::abs(status.theta[axis][index] - replayed.theta[index]) <= kSameError)) return true;
    }
  }
  return false;
}

// A sample with what the node said of it.
struct Recorded {
  const ReplaySample* sample = nullptr;
  bool commands_agree = false;
  // Whether the node answered these errors; none where its status is not recorded.
  std::optional<bool> errors_agree;
};

std::vector<Recorded> recordedSamples(const FlightLog& log, const std::vector<ReplaySample>& samples,
                                      const AxisMaps& maps, double mass, double tolerance) {
  std::map<double, const AttitudeCommand*> commands;
  for (const FlightLog::Command& command : log.commands) commands[command.stamp] = &command.command;
  std::map<double, const FlightLog::Status*> statuses;
  for (const FlightLog::Status& status : log.statuses) {
    if (status.reason != ControlReason::kStale) statuses[status.stamp] = &status;
  }
  std::vector<Recorded> all;
  for (const ReplaySample& sample : samples) {
    Recorded one = {&sample, true, std::nullopt};
    const auto command = commands.find(sample.state.stamp);
    if (command != commands.end())
      one.commands_agree = distance(*command->second, sample.report.command, mass) <= tolerance;
    const auto status = statuses.find(sample.state.stamp);
    if (status != statuses.end()) one.errors_agree = !answeredOther(*status->second, sample.report, maps);
    all.push_back(one);
  }
  return all;
}

// Whether the node answered other errors here, but soon the recorded ones again.
bool isAltered(const std::vector<Recorded>& samples, std::size_t place) {
  if (samples[place].errors_agree.value_or(true)) return false;
  const std::size_t end = std::min(samples.size(), place + kMostAltered);
  return std::any_of(samples.begin() + static_cast<std::ptrdiff_t>(place),
                     samples.begin() + static_cast<std::ptrdiff_t>(end),
                     [](const Recorded& one) { return one.errors_agree.value_or(false); });
}

}  // namespace

ComparableSamples comparableSamples(const FlightLog& log, const std::vector<ReplaySample>& samples,
                                    const AxisMaps& maps, double mass, double tolerance) {
  const std::vector<Recorded> recorded = recordedSamples(log, samples, maps, mass, tolerance);
  ComparableSamples result;
  std::vector<bool> known, compared;
  bool together = true;
  std::size_t agreeing = 0;
  for (std::size_t place = 0; place < recorded.size(); ++place) {
    const auto& [sample, commands_agree, errors_agree] = recorded[place];
    if (together && !commands_agree && agreeing > 0 && isAltered(recorded, place)) {
      together = false;
      result.stretches.push_back({sample->state.stamp, sample->state.stamp, 0});
    }
    agreeing = commands_agree ? agreeing + 1 : 0;
    known.push_back(together || errors_agree.value_or(false));
    compared.push_back(together);
    if (!together) {
      result.stretches.back().to = sample->state.stamp;
      ++result.stretches.back().samples;
      together = agreeing >= kAgreeing;
    }
  }
  if (result.stretches.empty()) return result;
  for (std::size_t place = 0; place < samples.size(); ++place) {
    if (known[place]) result.known.push_back(samples[place]);
    if (compared[place]) result.compared.push_back(samples[place]);
  }
  return result;
}

}  // namespace polyfly
