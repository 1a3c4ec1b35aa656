// How the multirotor's linear laws are made of their axes.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "online_controller/laws/multirotor_controller.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

/// A silent exchange of two maps would be noticed by their signals; a missing one here.
const RegionMap& given(const RegionMap* map, const AxisNames& names) {
  if (map == nullptr) throw Error(std::string(names.axis) + " map: missing");
  return *map;
}

/// Each axis with its law, `law_of(axis)`.
template <class LawOf>
std::array<Axis, 3> makeAxes(const MultirotorOptions& options, const LawOf& law_of) {
  checkOptions(options);
  const auto axis = [&](std::size_t i) { return Axis(law_of(i), kAxisNames[i], options); };
  return {axis(0), axis(1), axis(2)};
}

/// Sampling time of the axes' minimum-peak maps, 0 where there are none.
double decisionPeriod(const std::array<Axis, 3>& axes) {
  const double first = axes[0].problem().minimum_peak ? axes[0].problem().sampling_time : 0.0;
  for (const Axis& axis : axes) {
    const double period = axis.problem().minimum_peak ? axis.problem().sampling_time : 0.0;
    if (period != first) {
      throw Error(axis.problem().source +
                  ": sampling_time: maps of a minimum-peak robust MPC must all have the same, got " +
                  std::to_string(period) + " s beside " + std::to_string(first) + " s (0: of another type)");
    }
  }
  return first;
}

SamplingClock decisionClock(const std::array<Axis, 3>& axes, double control_period) {
  constexpr double kWhole = 1e-6;  // how far a ratio of periods may be from a whole number
  const double period = decisionPeriod(axes);
  if (period == 0.0) return {};
  const double samples = period / control_period;
  if (samples < 1.0 - kWhole || std::abs(samples - std::round(samples)) > kWhole * samples) {
    throw Error(
        "controller/control_period: what the maps of a minimum-peak robust MPC promise holds at their "
        "sampling time of " +
        std::to_string(period) + " s, which must be a whole number of control periods, got " +
        std::to_string(control_period) + " s");
  }
  return {period, control_period};
}

/// A minimum-peak robust MPC answers for the whole disturbance: what an estimate took away would be answered
/// twice. Axis::disturbance() takes its constant part alone.
MultirotorOptions offsetOptions(const std::array<Axis, 3>& axes, MultirotorOptions options) {
  if (!axes[0].problem().minimum_peak) return options;
  options.integrator = false;
  options.offset_free = false;
  return options;
}

TiltModel tiltModel(const std::array<Axis, 3>& axes) {
  return {axes[1].lagGain(), axes[1].lagTime(), axes[0].lagGain(), axes[0].lagTime()};
}

/// One delay, because one message commands all axes: the mean of those that the attitude's problems state.
VehicleModel modelOf(const std::array<Axis, 3>& axes, const MultirotorOptions& options) {
  VehicleModel model;
  model.motion = {options.gravity,   axes[1].lagGain(), axes[1].lagTime(),
                  axes[0].lagGain(), axes[0].lagTime(), {axes[0].drag(), axes[1].drag(), axes[2].drag()}};
  model.roll = axes[1].loop();
  model.pitch = axes[0].loop();
  const double longitudinal = axes[0].problem().delay, lateral = axes[1].problem().delay;
  model.delay =
      longitudinal > 0.0 && lateral > 0.0 ? 0.5 * (longitudinal + lateral) : std::max(longitudinal, lateral);
  return model;
}

/// Looks ahead where all axes can, to the same times.
LawTiming timingOf(const std::array<Axis, 3>& axes) {
  const double period = axes[0].stagePeriod();
  const int stages = axes[0].stages();
  for (const Axis& axis : axes) {
    if (axis.stages() != stages || axis.stagePeriod() != period) return {1, 0.0, period};
  }
  return stages == 0 ? LawTiming{1, 0.0, period} : LawTiming{stages + 1, period, period};
}

}  // namespace

MultirotorController::MultirotorController(const std::array<const RegionMap*, 3>& maps,
                                           const MultirotorOptions& options)
    : MultirotorController(makeAxes(options,
                                    [&](std::size_t i) {
                                      const RegionMap& map = given(maps[i], kAxisNames[i]);
                                      return explicitAxisLaw(map, problemOf(map, kAxisNames[i].axis));
                                    }),
                           options) {}

MultirotorController::MultirotorController(const std::array<const RegionMap*, 3>& maps,
                                           const std::array<MpcProblem, 3>& problems,
                                           const MultirotorOptions& options)
    : MultirotorController(makeAxes(options,
                                    [&](std::size_t i) {
                                      return explicitAxisLaw(given(maps[i], kAxisNames[i]), problems[i]);
                                    }),
                           options) {}

MultirotorController::MultirotorController(const std::array<MpcProblem, 3>& problems,
                                           const MultirotorOptions& options)
    : MultirotorController(makeAxes(options, [&](std::size_t i) { return onlineAxisLaw(problems[i]); }),
                           options) {}

MultirotorController::MultirotorController(std::array<Axis, 3> axes, const MultirotorOptions& options)
    : EstimatingLaw(timingOf(axes), modelOf(axes, options), options, tiltModel(axes),
                    offsetOptions(axes, options)),
      axes_(std::move(axes)),
      clock_(decisionClock(axes_, options.control_period)) {
  forgetAll();
}

}  // namespace polyfly
