#include "identification/several_motions.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/several_flights.hpp"
#include "motion_judgement.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Pause between flights on one clock; more than a far step, so that nothing spans it [s].
constexpr double kMotionPause = kFarStep + 10.0;

TimeWindow movedBy(const TimeWindow& window, double by) { return {window.from + by, window.to + by}; }

std::vector<std::string> commonPlaces(const std::vector<FlightSignals>& flights) {
  std::vector<std::string> common;
  for (const std::string& place : flights.front().places) {
    const bool everywhere =
        std::all_of(flights.begin(), flights.end(), [&place](const FlightSignals& flight) {
          return std::find(flight.places.begin(), flight.places.end(), place) != flight.places.end();
        });
    if (everywhere) common.push_back(place);
  }
  return common;
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

TimeWindow spanOf(const FlightSignals& flight) {
  TimeWindow span = {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (const auto& [name, series] : flight.series) {
    for (const double time : series.time) {
      if (!std::isfinite(time)) continue;
      span.from = std::min(span.from, time);
      span.to = std::max(span.to, time);
    }
  }
  return span;
}

void append(FlightSignals piece, FlightSignals* recording) {
  if (piece.thrust_is_share != recording->thrust_is_share) piece.series.erase("thrust_cmd");
  for (auto& [name, series] : piece.series) {
    TimeSeries& all = recording->series[name];
    all.time.insert(all.time.end(), series.time.begin(), series.time.end());
    all.value.insert(all.value.end(), series.value.begin(), series.value.end());
    recording->origin.try_emplace(name, piece.origin[name]);
  }
  recording->lossy = recording->lossy || piece.lossy;
  recording->not_flight.insert(recording->not_flight.end(), piece.not_flight.begin(), piece.not_flight.end());
}

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
    if (!(span.from <= span.to)) throw Error(flight.source + ": holds no sample");
    joined.shifts.push_back(next - span.from);
    joined.spans.push_back(movedBy(span, joined.shifts.back()));
    next = joined.spans.back().to + kMotionPause;
    for (const RejectedWindow& one : flight.not_flight)
      all.not_flight.push_back({movedBy(one.window, joined.shifts.back()), one.reason});
    for (const auto& [name, series] : flight.series) {
      const bool common = std::all_of(flights.begin(), flights.end(),
                                      [name = name](const FlightSignals& other) { return other.has(name); });
      if (!common) continue;
      TimeSeries& one = all.series[name];
      for (const double time : series.time) one.time.push_back(time + joined.shifts.back());
      one.value.insert(one.value.end(), series.value.begin(), series.value.end());
    }
  }
  all.places = commonPlaces(flights);
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
  // Those of the rotors come last.
  const std::size_t rotors = 2 * result.traces.size();
  for (std::size_t i = rotors; i < result.parameters.size(); ++i) {
    result.parameters[i].supported = sound;
    judgeDrag(result.parameters[i], &result.warnings);
  }
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
  judgeMass(&result.parameters, &result.warnings);
  // The model is proportional to its first parameter.
  for (double& value : result.traces.front().modelled) value *= result.parameters.front().value / before;
  return result;
}

}  // namespace polyfly
