#include "identification/flight_signals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/signal_units.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

constexpr double kStandardGravity = 9.8066;  // [m/s^2]
constexpr const char* kLoops[] = {"roll", "pitch", "yaw_rate", "thrust"};
constexpr double kThrustSmoothing = 0.1;  // half width of the mean over noisy accelerations [s]

// Acceleration along the body's z without gravity's, from what the vehicle did vertically.
TimeSeries thrustFromVelocity(const FlightSignals& signals) {
  const TimeSeries velocity = cleaned(signals.at("vz"));
  const TimeSeries roll = cleaned(signals.at("roll"));
  const TimeSeries pitch = cleaned(signals.at("pitch"));
  TimeSeries thrust;
  if (velocity.time.size() < 3 || roll.time.empty() || pitch.time.empty()) return thrust;
  thrust.time = velocity.time;
  thrust.value = smoothedMean(velocity.time, velocity.value, kThrustSmoothing);
  for (std::size_t i = 0; i < thrust.time.size(); ++i) {
    const double upright =
        std::cos(interpolated(roll, thrust.time[i])) * std::cos(interpolated(pitch, thrust.time[i]));
    thrust.value[i] = (thrust.value[i] + kStandardGravity) / upright;
  }
  return thrust;
}

TimeSeries smoothed(const TimeSeries& raw) {
  TimeSeries series = cleaned(raw);
  if (series.time.size() < 3) return series;
  series.value = smoothedMean(series.time, cumulativeIntegral(series.time, series.value), kThrustSmoothing);
  return series;
}

std::string listOfPlaces(const FlightSignals& signals) {
  constexpr std::ptrdiff_t kMostPlaces = 60;
  const auto count = static_cast<std::ptrdiff_t>(signals.places.size());
  if (count <= kMostPlaces) return listOf(signals.places);
  return listOf(std::vector<std::string>(signals.places.begin(), signals.places.begin() + kMostPlaces)) +
         " and " + std::to_string(count - kMostPlaces) + " more";
}

}  // namespace

const TimeSeries& FlightSignals::at(const std::string& name) const {
  const auto found = series.find(name);
  if (found != series.end()) return found->second;
  const std::string known = listOfPlaces(*this);
  throw Error(source + ": no signal " + name + "; choose one with --signal " + name + "=COLUMN" +
              (known.empty() ? "" : "; the log has " + known));
}

double angleOf(double w, double x, double y, double z, const std::string& angle) {
  if (angle == "roll") return std::atan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y));
  if (angle == "pitch") return std::asin(std::fmax(-1.0, std::fmin(1.0, 2.0 * (w * y - z * x)))) + 0.0 * w;
  if (angle == "yaw") return std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z));
  return std::numeric_limits<double>::quiet_NaN();
}

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

double ChosenPlace::factor() const { return sign * (in_degrees ? kRadiansPerDegree : 1.0); }

ChosenPlace chosenPlace(const std::string& signal, const std::string& text) {
  const std::vector<std::string>& names = signalNames();
  if (std::find(names.begin(), names.end(), signal) == names.end()) {
    throw Error("--signal " + signal + ": is none of " + listOf(names));
  }
  ChosenPlace chosen{text};
  if (!text.empty() && text.front() == '-') {
    chosen.sign = -1.0;
    chosen.place.erase(0, 1);
  }
  const std::string degrees = ":deg";
  chosen.in_degrees = endsWith(chosen.place, degrees);
  if (chosen.in_degrees) chosen.place.resize(chosen.place.size() - degrees.size());
  return chosen;
}

TimeSeries cleanSignal(const FlightSignals& signals, const std::string& name) {
  return signals.has(name) ? cleaned(signals.at(name)) : TimeSeries{};
}

std::vector<std::string> clockRemarks(const FlightSignals& signals) {
  std::vector<std::pair<std::vector<std::string>, std::string>> told;  // sentences, names
  for (const auto& [name, series] : signals.series) {
    const std::vector<std::string> sentences = sentencesOn(farSteps(series.time));
    const auto same = std::find_if(told.begin(), told.end(),
                                   [&sentences](const auto& one) { return one.first == sentences; });
    if (same != told.end()) {
      same->second += ", " + name;
    } else if (!sentences.empty()) {
      told.emplace_back(sentences, name);
    }
  }
  std::vector<std::string> remarks;
  for (const auto& [sentences, names] : told) {
    for (const std::string& sentence : sentences) remarks.push_back(names + ": " + sentence + "; cut there");
  }
  return remarks;
}

bool isAuxiliary(const std::string& name) { return name.compare(0, 5, "gyro_") == 0; }

namespace {

// What the log lacks of a loop; empty: nothing.
std::string missingFor(const FlightSignals& signals, const std::string& axis) {
  std::string missing = signals.has(axis + "_cmd") ? "" : axis + "_cmd";
  const bool vertical = signals.has("vz") && signals.has("roll") && signals.has("pitch");
  const bool thrust = axis == "thrust";
  if (thrust ? signals.has("specific_force_z") || vertical : signals.has(axis)) return missing;
  return missing + (missing.empty() ? "" : " and no ") +
         (thrust ? "specific_force_z, nor vz with roll and pitch" : axis);
}

}  // namespace

std::vector<std::string> missingAxes(const FlightSignals& signals) {
  std::vector<std::string> sentences;
  for (const char* axis : kLoops) {
    const std::string missing = missingFor(signals, axis);
    if (!missing.empty())
      sentences.push_back(std::string(axis) + " is not identified: the log has no " + missing);
  }
  const std::string known = listOfPlaces(signals);
  if (!sentences.empty() && !known.empty())
    sentences.push_back("--signal chooses the place of a signal; the log has " + known);
  return sentences;
}

std::vector<std::string> recordedAxes(const FlightSignals& signals) {
  std::vector<std::string> axes;
  for (const char* axis : kLoops) {
    if (missingFor(signals, axis).empty()) axes.emplace_back(axis);
  }
  return axes;
}

AxisRecords axisRecords(const FlightSignals& signals, const std::string& axis) {
  AxisRecords records;
  records.axis = axis;
  records.training.source = signals.source;
  records.training.not_flight = signals.not_flight;
  records.training.command = signals.at(axis + "_cmd");
  if (axis == "thrust") {
    records.unit = "m/s^2";
    records.command_unit = "command";
    records.training.smoothing = kThrustSmoothing;
    records.training.response = signals.has("specific_force_z") ? smoothed(signals.at("specific_force_z"))
                                                                : thrustFromVelocity(signals);
    if (signals.has("vz")) records.vertical_velocity = cleaned(signals.at("vz"));
    return records;
  }
  records.unit = records.command_unit = axis == "yaw_rate" ? "rad/s" : "rad";
  records.training.response = signals.at(axis);
  records.command_help = otherUnit(signals, axis + "_cmd");
  records.response_help = otherUnit(signals, axis);
  const std::string other = axis == "roll" ? "pitch_cmd" : "roll_cmd";
  if (axis != "yaw_rate" && signals.has(other)) records.other_command = cleaned(signals.at(other));
  return records;
}

}  // namespace polyfly
