#pragma once

#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "online_controller/laws/law_switch.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/reference/reference_schedule.hpp"
#include "validation/flight_log.hpp"
#include "validation/replay.hpp"

namespace polyfly {

/// Adds what the node records of a step to the log.
inline void record(const ControlReport& report, double stamp, FlightLog& log) {
  log.commands.push_back({stamp, report.command});
  FlightLog::Status status;
  status.stamp = stamp;
  status.status = report.status;
  status.reason = report.reason;
  for (std::size_t axis = 0; axis < report.axis.size(); ++axis) {
    const AxisReport& of = report.axis[axis];
    status.region[axis] = of.region;
    status.theta[axis].assign(of.theta.begin(), of.theta.begin() + of.size);
  }
  log.statuses.push_back(status);
}

/// Flies a plant for so long by maps, as the node does, without the replay's code. The plant has measure(), advance() and
/// time().
template <class Plant>
FlightLog recordedFlight(const AxisMaps& maps, const MultirotorOptions& options,
                         const ReferenceTrajectory& trajectory, Plant& plant, double seconds) {
  LawSwitch law(std::make_unique<MultirotorController>(maps, options), options);
  ReferenceSchedule schedule;
  schedule.set(trajectory, std::nullopt);
  FlightLog log;
  log.source = "made flight";
  log.add(trajectory, std::nullopt);
  std::vector<Reference> preview(static_cast<std::size_t>(law.previewLength()));
  while (plant.time() < seconds) {
    const VehicleState state = plant.measure();
    log.add(state);
    schedule.preview(state.stamp, law.previewPeriod(), law.previewLength(), preview.data());
    const ControlReport& report = law.step(state, preview.data());
    record(report, state.stamp, log);
    plant.advance(report.command);
    law.prepare();
  }
  return log;
}

}  // namespace polyfly
