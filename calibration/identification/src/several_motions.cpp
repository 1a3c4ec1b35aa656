#include "identification/several_motions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "drag_judgement.hpp"
#include "identification/several_flights.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Pause between flights on one clock; more than a far step, so that nothing spans it [s].
constexpr double kMotionPause = kFarStep + 10.0;

TimeWindow spanOf(const FlightSignals& flight) {
  TimeWindow span = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const auto& [name, series] : flight.series) {
    for (const double time : series.time) {
      if (!std::isfinite(time)) continue;
      span.from = std::min(span.from, time);
      span.to = std::max(span.to, time);
    }
  }
  if (!(span.from <= span.to)) throw Error(flight.source + ": holds no sample");
  return span;
}

// What must be alike for one model.
void checkAlike(const Motion& joint, const std::vector<Motion>& flights) {
  for (const Motion& flight : flights) {
    if (flight.thrust_known != joint.thrust_known || flight.lift_is_share != joint.lift_is_share)
      throw Error(flight.source +
                  ": its thrust_cmd is not that of the other flights: missing, or of another unit");
  }
}

SeveralFit pooled(MotionFit all, const std::vector<MotionFit>& fits) {
  SeveralFit result;
  static_cast<MotionFit&>(result) = std::move(all);
  for (const MotionFit& fit : fits) result.flights.push_back(fit.parameters);
  result.parameters = poolParameters(result.flights);
  return result;
}

}  // namespace

JoinedFlights joinFlights(const std::vector<FlightSignals>& flights) {
  JoinedFlights joined;
  FlightSignals& all = joined.signals;
  all.thrust_is_share = flights.front().thrust_is_share;
  double next = 0.0;
  for (const FlightSignals& flight : flights) {
    if (flight.has("thrust_cmd") && flight.thrust_is_share != all.thrust_is_share)
      throw Error(flight.source + ": thrust_cmd has another unit than in " + flights.front().source);
    all.source += (all.source.empty() ? "" : ", ") + flight.source;
    const TimeWindow span = spanOf(flight);
    joined.shifts.push_back(next - span.from);
    next = span.to + joined.shifts.back() + kMotionPause;
    for (const auto& [name, series] : flight.series) {
      const bool common = std::all_of(flights.begin(), flights.end(),
                                      [name = name](const FlightSignals& other) { return other.has(name); });
      if (!common) continue;
      TimeSeries& one = all.series[name];
      for (const double time : series.time) one.time.push_back(time + joined.shifts.back());
      one.value.insert(one.value.end(), series.value.begin(), series.value.end());
    }
  }
  return joined;
}

SeveralFit fitDragOf(const Motion& joint, const std::vector<Motion>& flights) {
  checkAlike(joint, flights);
  MotionFit all = fitDrag(joint);
  std::vector<MotionFit> fits;
  for (const Motion& flight : flights) fits.push_back(fitDrag(flight));
  all.warnings = checkMotion(joint);
  const bool sound = all.warnings.empty();
  SeveralFit result = pooled(std::move(all), fits);
  // Each axis has its coefficient and its offset, and one trace, which is straight in the velocity.
  for (std::size_t axis = 0; axis < result.traces.size(); ++axis) {
    FittedParameter& drag = result.parameters[2 * axis];
    drag.supported = sound;
    judgeDrag(drag, &result.warnings);
    result.parameters[2 * axis + 1].supported = true;
    MotionTrace& trace = result.traces[axis];
    for (std::size_t i = 0; i < trace.modelled.size(); ++i)
      trace.modelled[i] = result.parameters[2 * axis + 1].value - drag.value * trace.depends[i];
  }
  return result;
}

SeveralFit fitMassOf(const Motion& joint, const std::vector<Motion>& flights, const MotionOptions& options) {
  checkAlike(joint, flights);
  MotionFit all = fitMass(joint, options);
  std::vector<MotionFit> fits;
  for (const Motion& flight : flights) fits.push_back(fitMass(flight, options));
  const double before = all.parameters.front().value;
  SeveralFit result = pooled(std::move(all), fits);
  // The model is proportional to its first parameter.
  for (double& value : result.traces.front().modelled) value *= result.parameters.front().value / before;
  return result;
}

}  // namespace polyfly
