#include "identification/signal_units.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
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
// Time over which an angle's change is compared with its rate, and step between comparisons [s].
constexpr double kChange = 0.4;
constexpr double kCompareStep = 0.2;
constexpr std::size_t kLeastCompared = 50;
// Correlation from which on two signals tell each other's unit, and ratio of equal units.
constexpr double kTells = 0.8;
constexpr double kEqualUnits = 3.0;
// Gravity as the accelerometer may show it, as a ratio.
constexpr double kForceMargin = 1.5;
constexpr double kGravityShown = 9.80665;  // [m/s^2]
// Behind a place: its angles are degrees.
constexpr const char* kDegreeMark = ":deg";

std::string placeOf(const FlightSignals& signals, const std::string& name) {
  const auto origin = signals.origin.find(name);
  return origin == signals.origin.end() ? "PLACE" : origin->second;
}

// The option that takes a signal for the other unit of angles.
std::string otherUnit(const FlightSignals& signals, const std::string& name) {
  const std::string place = placeOf(signals, name);
  const std::string option = "--signal " + name + "=";
  if (!endsWith(place, kDegreeMark)) return option + place + kDegreeMark + " takes it for degrees";
  return option + place.substr(0, place.size() - std::strlen(kDegreeMark)) + " takes it for radians";
}

// Whether an angle lies beyond pi, as none in radians does in flight.
bool isBeyond(const TimeSeries& series) {
  const auto beyond = std::count_if(series.value.begin(), series.value.end(),
                                    [](double value) { return std::abs(value) > kHalfTurn + kBeyondMargin; });
  return static_cast<double>(beyond) > kBeyondShare * static_cast<double>(series.value.size());
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

// How the changes of an angle go with the integral of its rate.
struct Comparison {
  double ratio = 0.0;
  double correlation = 0.0;
};

Comparison changeAgainstRate(const TimeSeries& angle, const TimeSeries& rate) {
  if (angle.time.empty() || rate.time.empty()) return {};
  const TimeSeries integral = {rate.time, cumulativeIntegral(rate.time, rate.value)};
  double products = 0.0;
  double changes = 0.0;
  double turns = 0.0;
  std::size_t count = 0;
  for (const TimeWindow& piece : cutAtFarSteps({{angle.time.front(), angle.time.back()}}, angle.time)) {
    for (double time = piece.from; time + kChange <= piece.to; time += kCompareStep, ++count) {
      const double change = interpolated(angle, time + kChange) - interpolated(angle, time);
      const double turn = interpolated(integral, time + kChange) - interpolated(integral, time);
      products += change * turn;
      changes += change * change;
      turns += turn * turn;
    }
  }
  if (count < kLeastCompared || !(changes > 0.0 && turns > 0.0)) return {};
  return {std::sqrt(changes / turns), products / std::sqrt(changes * turns)};
}

void checkAngle(const FlightSignals& signals, const std::string& name,
                const std::vector<TimeWindow>& left_out) {
  if (!isBeyond(without(cleanSignal(signals, name), left_out))) return;
  throw Error(signals.source + ": " + name + ": lies beyond pi in flight; " + otherUnit(signals, name));
}

void checkRate(const FlightSignals& signals, const std::string& angle, const std::string& rate,
               const std::vector<TimeWindow>& left_out, std::vector<std::string>* remarks) {
  const Comparison found =
      changeAgainstRate(without(cleanSignal(signals, angle), left_out), cleanSignal(signals, rate));
  if (std::abs(found.correlation) < kTells) return;
  if (found.correlation < 0.0)
    remarks->push_back(angle + " and " + rate + " have opposite signs: one of them is of another frame");
  if (found.ratio < kEqualUnits && found.ratio > 1.0 / kEqualUnits) return;
  const std::string text = sentence(" changes by %.3g times what ", found.ratio);
  const std::string& greater = found.ratio > 1.0 ? angle : rate;
  remarks->push_back(angle + text + rate + " says: their units differ; " + otherUnit(signals, greater));
}

// Drops an accelerometer that does not show gravity.
void checkForce(FlightSignals* signals, const std::vector<TimeWindow>& left_out,
                std::vector<std::string>* remarks) {
  std::vector<double> values = without(cleanSignal(*signals, "specific_force_z"), left_out).value;
  if (values.size() < kLeastCompared) return;
  const double middle = quantileOf(std::move(values));
  if (middle < kForceMargin * kGravityShown && middle > kGravityShown / kForceMargin) return;
  const std::string text =
      sentence("specific_force_z shows %.3g m/s^2 where gravity is +9.81: not used; ", middle);
  const std::string help =
      middle < 0.0 ? "--signal specific_force_z=-" + placeOf(*signals, "specific_force_z") + " turns its sign"
                   : "give it in m/s^2, with gravity";
  remarks->push_back(text + help);
  signals->series.erase("specific_force_z");
}

}  // namespace

std::vector<std::string> checkUnits(FlightSignals* signals, bool on_ground) {
  const std::vector<TimeWindow> left_out = withoutUnits(*signals, on_ground);
  for (const char* angle : {"roll", "pitch", "roll_cmd", "pitch_cmd"}) checkAngle(*signals, angle, left_out);
  std::vector<std::string> remarks;
  checkRate(*signals, "roll", "gyro_x", left_out, &remarks);
  checkRate(*signals, "pitch", "gyro_y", left_out, &remarks);
  checkForce(signals, left_out, &remarks);
  return remarks;
}

}  // namespace polyfly
