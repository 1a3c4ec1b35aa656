#include "identification/signal_units.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/flight_phases.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/quantile.hpp"
#include "polyfly_base/read_text.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;
// An angle is beyond pi if it is so for this share of the flight, and by this much [rad].
constexpr double kBeyondShare = 0.005;
constexpr double kBeyondMargin = 0.005;
// Share of the record that must be flight for the units to be judged in it.
constexpr double kLeastFlown = 0.5;
// Gravity as the accelerometer may show it, as a ratio, and samples that tell.
constexpr double kForceMargin = 1.5;
constexpr double kGravityShown = 9.80665;  // [m/s^2]
constexpr std::size_t kLeastSamples = 50;

std::string placeOf(const FlightSignals& signals, const std::string& name) {
  const auto origin = signals.origin.find(name);
  return origin == signals.origin.end() ? "PLACE" : origin->second;
}

// Where units are not judged: what is no flight, if all signals are in their units and the rest is most of the record.
// With other units hardly anything is flight.
std::vector<TimeWindow> withoutUnits(const FlightSignals& signals, bool on_ground) {
  std::vector<TimeWindow> windows;
  double left_out = 0.0;
  for (const RejectedWindow& one : findNonFlight(signals, on_ground)) {
    windows.push_back(one.window);
    left_out += one.window.to - one.window.from;
  }
  const TimeWindow span = spanOf(signals);
  return left_out < kLeastFlown * (span.to - span.from) ? windows : std::vector<TimeWindow>();
}

// Whether an angle lies beyond pi, as none in radians does in flight.
void checkAngle(const FlightSignals& signals, const std::string& name,
                const std::vector<TimeWindow>& left_out) {
  const std::vector<double> values = without(cleanSignal(signals, name), left_out).value;
  const auto beyond = std::count_if(values.begin(), values.end(),
                                    [](double value) { return std::abs(value) > kHalfTurn + kBeyondMargin; });
  if (static_cast<double>(beyond) <= kBeyondShare * static_cast<double>(values.size())) return;
  throw Error(signals.source + ": " + name + ": lies beyond pi in flight; " + otherUnit(signals, name));
}

// Drops an accelerometer that does not show gravity.
void checkForce(FlightSignals* signals, const std::vector<TimeWindow>& left_out,
                std::vector<std::string>* remarks) {
  std::vector<double> values = without(cleanSignal(*signals, "specific_force_z"), left_out).value;
  if (values.size() < kLeastSamples) return;
  const double middle = quantileOf(std::move(values));
  if (middle < kForceMargin * kGravityShown && middle > kGravityShown / kForceMargin) return;
  remarks->push_back(
      sentence("specific_force_z shows %.3g m/s^2 where gravity is +9.81: not used; ", middle) +
      (middle < 0.0
           ? "--signal specific_force_z=-" + placeOf(*signals, "specific_force_z") + " turns its sign"
           : "give it in m/s^2, with gravity"));
  signals->series.erase("specific_force_z");
}

}  // namespace

std::string otherUnit(const FlightSignals& signals, const std::string& name) {
  const std::string mark = ":deg";
  std::string place = placeOf(signals, name);
  const bool in_degrees = endsWith(place, mark);
  place = in_degrees ? place.substr(0, place.size() - mark.size()) : place + mark;
  return "--signal " + name + "=" + place + " takes it for " + (in_degrees ? "radians" : "degrees");
}

std::vector<std::string> checkUnits(FlightSignals* signals, bool on_ground) {
  const std::vector<TimeWindow> left_out = withoutUnits(*signals, on_ground);
  for (const char* angle : {"roll", "pitch", "roll_cmd", "pitch_cmd"}) checkAngle(*signals, angle, left_out);
  std::vector<std::string> remarks;
  checkForce(signals, left_out, &remarks);
  return remarks;
}

}  // namespace polyfly
