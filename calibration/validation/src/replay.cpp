#include "validation/replay.hpp"

#include <algorithm>
#include <memory>
#include <optional>
#include <set>
#include <string>

#include "online_controller/estimation/odometry_gate.hpp"
#include "online_controller/laws/axis.hpp"
#include "online_controller/laws/law_switch.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "polyfly_base/error.hpp"
#include "record_follower.hpp"
#include "region_maps/region_map.hpp"
#include "validation/parameters_told.hpp"

namespace polyfly {
namespace {

bool hasParameter(const RegionMap& map, const char* name) {
  return std::any_of(map.parameters().begin(), map.parameters().end(),
                     [name](const Signal& signal) { return signal.name == name; });
}

// Stamps of the odometry that the node answered; empty if the commands bear none of them.
std::set<double> answeredStamps(const FlightLog& log) {
  const auto commanded = log.commandsByStamp();
  std::set<double> answered;
  for (const VehicleState& state : log.odometry) {
    if (commanded.count(state.stamp) > 0) answered.insert(state.stamp);
  }
  return answered;
}

}  // namespace

std::size_t axisOf(const RegionMap& map) {
  const auto fits = std::find_if(kAxisNames.begin(), kAxisNames.end(), [&map](const AxisNames& names) {
    return hasParameter(map, names.position_error);
  });
  if (fits == kAxisNames.end()) {
    throw Error(map.path() +
                ": parameters: none is e_p_x, e_p_y or e_p_z, so it serves no axis of a multirotor");
  }
  return static_cast<std::size_t>(fits - kAxisNames.begin());
}

AxisMaps assignAxes(const std::vector<const RegionMap*>& maps) {
  AxisMaps assigned{};
  for (const RegionMap* map : maps) {
    const std::size_t axis = axisOf(*map);
    if (assigned[axis] != nullptr) {
      throw Error(map->path() + ": parameters: " + kAxisNames[axis].axis + " axis already has the map " +
                  assigned[axis]->path() + "; another one takes a run of its own");
    }
    assigned[axis] = map;
  }
  for (std::size_t axis = 0; axis < assigned.size(); ++axis) {
    if (assigned[axis] == nullptr) {
      throw Error(std::string("maps: none for the ") + kAxisNames[axis].axis + " axis (parameter " +
                  kAxisNames[axis].position_error + ")");
    }
  }
  return assigned;
}

namespace {

std::vector<ReplaySample> replayed(const FlightLog& log, const AxisMaps& maps,
                                   const MultirotorOptions& options, RecordFollower* follower) {
  const std::set<double> answered = answeredStamps(log);
  LawSwitch law(std::make_unique<MultirotorController>(maps, options), options);
  std::vector<Reference> preview(static_cast<std::size_t>(law.previewLength()));
  ReferenceSchedule schedule;
  OdometryGate gate(options);
  // Stamp of the last odometry that was accepted, or of the first [s]. No other moves the references.
  std::optional<double> accepted;
  std::vector<ReplaySample> samples;
  samples.reserve(log.odometry.size());
  for (const FlightLog::Event& event : log.events) {
    switch (event.kind) {
      case FlightLog::EventKind::kReference: {
        const FlightLog::TimedReference& reference = log.references.at(event.index);
        schedule.set(reference.trajectory, reference.start);
        break;
      }
      case FlightLog::EventKind::kSilence:
        gate.noteSilence();
        law.onSilence(log.silences.at(event.index));
        break;
      case FlightLog::EventKind::kOdometry: {
        VehicleState state = aligned(log.odometry.at(event.index), options.heading_misalignment);
        if (!answered.empty() && answered.count(state.stamp) == 0) break;
        ReplaySample sample;
        sample.state = state;
        const OdometryGate::Verdict verdict = gate.check(state);
        if (verdict.refusal == ControlReason::kNone || !accepted) accepted = state.stamp;
        const double time = *accepted;
        schedule.shift(verdict.time_jump);
        schedule.advance(time);
        sample.has_reference =
            schedule.preview(time + law.lead(), law.previewPeriod(), law.previewLength(), preview.data());
        if (sample.has_reference)
          sample.reference = law.lead() > 0.0 ? *schedule.sample(time) : preview.front();
        if (verdict.restarted) law.forget(LawMemory::kObserver);
        if (verdict.refusal == ControlReason::kStale) {
          gate.noteSilence();
          sample.report = law.onSilence(state.stamp);
        } else if (!sample.has_reference) {
          sample.report = law.stepWithoutReference(state.stamp);
        } else if (verdict.refusal != ControlReason::kNone) {
          sample.report = law.withoutSample(state.stamp, verdict.refusal);
        } else {
          sample.report = law.step(state, preview.data());
          if (verdict.contradicts) sample.report = byPositions(sample.report);
        }
        samples.push_back(sample);
        const AttitudeCommand* sent = follower->follow(&samples);
        if (sent != nullptr && sample.report.status != ControlStatus::kNoReference) law.correct(*sent);
        break;
      }
    }
  }
  return samples;
}

// The first parameter out of its range, or -1.
int firstOutside(const RegionMap& map, const std::vector<double>& theta) {
  for (std::size_t i = 0; i < theta.size(); ++i) {
    const Signal& signal = map.parameters()[i];
    if (!(theta[i] >= signal.lower && theta[i] <= signal.upper)) return static_cast<int>(i);
  }
  return -1;
}

// The replay of a flight of another version keeps references only: what the controller told takes the place of the rest.
// Where it told nothing, the map's parameters are not known.
void takeRecorded(const FlightLog& log, const AxisMaps& maps, std::vector<ReplaySample>* samples) {
  const auto recorded = log.statusesByStamp();
  for (ReplaySample& sample : *samples) {
    sample.ignorance = Ignorance::kVersion;
    const auto found = recorded.find(sample.state.stamp);
    sample.is_known = found != recorded.end();
    if (!sample.is_known) continue;
    const FlightLog::Status& status = *found->second;
    sample.report.status = status.status;
    sample.report.reason = status.reason;
    for (std::size_t axis = 0; axis < maps.size(); ++axis) {
      AxisReport& report = sample.report.axis[axis];
      const std::vector<double>& theta = status.theta[axis];
      if (!theta.empty() && theta.size() != maps[axis]->parameters().size())
        throw Error(maps[axis]->path() + ": has " + std::to_string(maps[axis]->parameters().size()) +
                    " parameters, and " + log.source + " records " + std::to_string(theta.size()));
      report = {};
      report.size = static_cast<int>(theta.size());
      std::copy(theta.begin(), theta.end(), report.theta.begin());
      report.input = status.input[axis];
      report.disturbance = status.disturbance[axis];
      if (theta.empty()) continue;
      const Lookup lookup = maps[axis]->locate(theta.data());
      report.lookup = lookup.status;
      report.outside_parameter = firstOutside(*maps[axis], theta);
      if (lookup.status == LookupStatus::kInside) report.region = lookup.region;
    }
  }
}

}  // namespace

std::vector<ReplaySample> replay(const FlightLog& log, const AxisMaps& maps, const MultirotorOptions& given,
                                 double preview_period, double tolerance) {
  MultirotorOptions options = given;
  const bool is_of_other = isOfOtherVersion(log);
  options.look_ahead = options.look_ahead && maps[0]->period() == preview_period;
  RecordFollower follower(log, maps, options.mass, tolerance);
  std::vector<ReplaySample> samples = replayed(log, maps, options, &follower);
  if (is_of_other) takeRecorded(log, maps, &samples);
  if (is_of_other || !follower.isOfAnother()) return samples;
  RecordFollower strict(log, maps, options.mass, tolerance);
  strict.beginTogether();
  return replayed(log, maps, options, &strict);
}

}  // namespace polyfly
