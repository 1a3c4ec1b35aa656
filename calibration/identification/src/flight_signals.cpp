#include "identification/flight_signals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "csv_times.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {
namespace {

constexpr double kRadiansPerDegree = 3.14159265358979323846 / 180.0;
constexpr double kStandardGravity = 9.8066;  // [m/s^2]
constexpr double kThrustSmoothing = 0.1;     // half width of the mean over noisy accelerations [s]

// How a signal may be called in a table: one of the stems, and one of the units behind it; any unit, or none,
// where there is no list. The first pattern that matches a column wins. `sign` turns z down into z up.
struct Pattern {
  const char* signal;
  std::vector<const char*> stems;
  std::vector<const char*> units;
  double sign = 1.0;
};

const std::vector<Pattern>& patterns() {
  static const std::vector<const char*> kAngle = {"rad", "deg"};
  static const std::vector<const char*> kRate = {"radps", "degps"};
  static const std::vector<const char*> kSpeed = {"mps"};
  static const std::vector<const char*> kForce = {"mps2"};
  static const std::vector<const char*> kLength = {"m"};
  static const std::vector<Pattern> kList = {
      {"roll_cmd", {"roll_cmd", "roll_ref", "roll_sp", "roll_des"}, kAngle},
      {"pitch_cmd", {"pitch_cmd", "pitch_ref", "pitch_sp", "pitch_des"}, kAngle},
      {"yaw_rate_cmd", {"yaw_rate_cmd", "yawrate_cmd", "yaw_rate_ref", "yaw_rate_sp", "yaw_rate_des"}, kRate},
      {"thrust_cmd",
       {"thrust_cmd", "thrust_ref", "thrust_sp", "thrust_out", "throttle_cmd", "throttle_ref", "throttle_sp",
        "throttle_out"},
       {}},
      {"roll", {"roll", "roll_vicon", "roll_imu", "roll_est"}, kAngle},
      {"pitch", {"pitch", "pitch_vicon", "pitch_imu", "pitch_est"}, kAngle},
      {"yaw", {"yaw", "yaw_vicon", "yaw_imu", "yaw_est", "heading"}, kAngle},
      {"yaw_rate", {"wz", "gz", "yaw_rate", "yawrate"}, kRate},
      {"specific_force_z", {"az"}, kForce},
      {"vx", {"vx"}, kSpeed},
      {"vy", {"vy"}, kSpeed},
      {"vz", {"vz"}, kSpeed},
      {"vz", {"vd"}, kSpeed, -1.0},
      {"vn", {"vn"}, kSpeed},
      {"ve", {"ve"}, kSpeed},
      {"airspeed", {"tas", "ias", "airspeed"}, kSpeed},
      {"gyro_x", {"wx", "gx", "roll_rate", "rollrate"}, kRate},
      {"gyro_y", {"wy", "gy", "pitch_rate", "pitchrate"}, kRate},
      {"gyro_z", {"wz", "gz"}, kRate},
      {"specific_force_x", {"ax"}, kForce},
      {"specific_force_y", {"ay"}, kForce},
      {"height", {"height", "z", "alt"}, kLength},
      {"height", {"down"}, kLength, -1.0},
  };
  return kList;
}

bool matches(const Pattern& pattern, const std::string& column) {
  for (const std::string stem : pattern.stems) {
    if (column == stem) return pattern.units.empty();
    if (column.compare(0, stem.size() + 1, stem + "_") != 0) continue;
    if (pattern.units.empty()) return true;
    const std::string unit = column.substr(stem.size() + 1);
    if (std::find(pattern.units.begin(), pattern.units.end(), unit) != pattern.units.end()) return true;
  }
  return false;
}

double unitOf(const std::string& column) {
  return endsWith(column, "_deg") || endsWith(column, "_degps") ? kRadiansPerDegree : 1.0;
}

bool isCommand(const std::string& signal) { return signal.find("_cmd") != std::string::npos; }

// The columns of a table with their times. Commands with times of their own are logged as they came; held onto
// other rows they repeat.
class CsvColumns {
 public:
  CsvColumns(const CsvLog& log, const std::map<std::string, std::string>& choice)
      : log_(log), times_(timesOf(log, choice)), command_times_(commandTimesOf(log, choice)) {}

  TimeSeries series(const std::string& signal, const std::string& column, double sign) const;
  std::vector<std::string> remarks() const;

 private:
  const CsvLog& log_;
  CsvTimes times_;
  CsvTimes command_times_;
};

TimeSeries CsvColumns::series(const std::string& signal, const std::string& column, double sign) const {
  const bool own_time = isCommand(signal) && !command_times_.seconds.empty();
  const std::vector<double>& times = (own_time ? command_times_ : times_).seconds;
  const std::vector<double>& values = log_.column(column);
  TimeSeries series;
  for (std::size_t i = 0; i < times.size(); ++i) {
    if (own_time && !series.time.empty() && times[i] == series.time.back()) continue;
    series.time.push_back(times[i]);
    series.value.push_back(sign * unitOf(column) * values[i]);
  }
  return series;
}

std::vector<std::string> CsvColumns::remarks() const {
  std::vector<std::string> remarks;
  if (log_.decimal_comma) remarks.emplace_back("its numbers have a decimal comma");
  if (log_.unreadable > 0)
    remarks.push_back(std::to_string(log_.unreadable) + " fields are neither a number nor empty");
  if (log_.cut_rows > 0)
    remarks.push_back(std::to_string(log_.cut_rows) + " rows have too few fields and were left out");
  return remarks;
}

std::string findColumn(const CsvLog& log, const Pattern& pattern) {
  const auto found = std::find_if(log.names.begin(), log.names.end(),
                                  [&pattern](const std::string& name) { return matches(pattern, name); });
  return found == log.names.end() ? std::string() : *found;
}

// Acceleration along the body's z without gravity's, from what the vehicle did vertically.
TimeSeries thrustFromVelocity(const FlightSignals& signals, CleaningCounts* counts) {
  const TimeSeries velocity = cleaned(signals.at("vz"), counts);
  const TimeSeries roll = cleaned(signals.at("roll"), counts);
  const TimeSeries pitch = cleaned(signals.at("pitch"), counts);
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

TimeSeries smoothed(const TimeSeries& raw, CleaningCounts* counts) {
  TimeSeries series = cleaned(raw, counts);
  if (series.time.size() < 3) return series;
  series.value = smoothedMean(series.time, cumulativeIntegral(series.time, series.value), kThrustSmoothing);
  return series;
}

std::string listOfPlaces(const FlightSignals& signals) {
  constexpr std::size_t kMostPlaces = 60;
  std::string list;
  for (std::size_t i = 0; i < std::min(signals.places.size(), kMostPlaces); ++i)
    list += (i > 0 ? ", " : "") + signals.places[i];
  if (signals.places.size() > kMostPlaces)
    list += " and " + std::to_string(signals.places.size() - kMostPlaces) + " more";
  return list;
}

}  // namespace

const TimeSeries& FlightSignals::at(const std::string& name) const {
  const auto found = series.find(name);
  if (found != series.end()) return found->second;
  const std::string known = listOfPlaces(*this);
  throw Error(source + ": no signal " + name + "; choose one with --signal " + name + "=COLUMN" +
              (known.empty() ? "" : "; the log has " + known));
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

const std::vector<std::string>& signalNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> list;
    for (const Pattern& pattern : patterns()) {
      if (std::find(list.begin(), list.end(), pattern.signal) == list.end())
        list.emplace_back(pattern.signal);
    }
    return list;
  }();
  return kNames;
}

double ChosenPlace::factor() const { return sign * (in_degrees ? kRadiansPerDegree : 1.0); }

ChosenPlace chosenPlace(const std::string& signal, const std::string& text) {
  const std::vector<std::string>& names = signalNames();
  if (std::find(names.begin(), names.end(), signal) == names.end()) {
    std::string known;
    for (const std::string& name : names) known += (known.empty() ? "" : ", ") + name;
    throw Error("--signal " + signal + ": is none of " + known);
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

FlightSignals signalsFromCsv(const CsvLog& log, const std::map<std::string, std::string>& choice) {
  FlightSignals signals;
  signals.source = log.path;
  const CsvColumns columns(log, choice);
  signals.remarks = columns.remarks();
  signals.places = log.names;
  for (const auto& [signal, column] : choice) {
    if (signal == "time" || signal == "cmd_time") continue;
    const ChosenPlace chosen = chosenPlace(signal, column);
    // What the name of the column says of its unit, the choice says again.
    const double named = chosen.in_degrees ? unitOf(chosen.place) : 1.0;
    signals.series[signal] = columns.series(signal, chosen.place, chosen.factor() / named);
    signals.origin[signal] = column;
  }
  for (const Pattern& pattern : patterns()) {
    if (signals.has(pattern.signal)) continue;
    const std::string column = findColumn(log, pattern);
    if (column.empty()) continue;
    signals.series[pattern.signal] = columns.series(pattern.signal, column, pattern.sign);
    signals.origin[pattern.signal] = column;
  }
  return signals;
}

bool isAuxiliary(const std::string& name) {
  return name.compare(0, 5, "gyro_") == 0 || name == "specific_force_x" || name == "specific_force_y" ||
         name == "height";
}

std::vector<std::string> missingAxes(const FlightSignals& signals) {
  const std::vector<std::string> found = recordedAxes(signals);
  std::vector<std::string> sentences;
  for (const std::string axis : {"roll", "pitch", "yaw_rate", "thrust"}) {
    if (std::find(found.begin(), found.end(), axis) != found.end()) continue;
    std::string missing = signals.has(axis + "_cmd") ? "" : axis + "_cmd";
    const bool vertical = signals.has("vz") && signals.has("roll") && signals.has("pitch");
    const bool answered = axis == "thrust" ? signals.has("specific_force_z") || vertical : signals.has(axis);
    if (!answered)
      missing += (missing.empty() ? "" : " and no ") +
                 (axis == "thrust" ? "specific_force_z, nor vz with roll and pitch" : axis);
    sentences.push_back(axis + " is not identified: the log has no " + missing);
  }
  const std::string known = listOfPlaces(signals);
  if (!sentences.empty() && !known.empty())
    sentences.push_back("--signal chooses the place of a signal; the log has " + known);
  return sentences;
}

std::vector<std::string> recordedAxes(const FlightSignals& signals) {
  std::vector<std::string> axes;
  for (const char* axis : {"roll", "pitch", "yaw_rate"}) {
    if (signals.has(axis) && signals.has(std::string(axis) + "_cmd")) axes.emplace_back(axis);
  }
  const bool vertical = signals.has("vz") && signals.has("roll") && signals.has("pitch");
  if (signals.has("thrust_cmd") && (signals.has("specific_force_z") || vertical)) axes.emplace_back("thrust");
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
    records.training.response = signals.has("specific_force_z")
                                    ? smoothed(signals.at("specific_force_z"), &records.cleaning)
                                    : thrustFromVelocity(signals, &records.cleaning);
    if (signals.has("vz")) records.vertical_velocity = cleaned(signals.at("vz"));
    return records;
  }
  records.unit = records.command_unit = axis == "yaw_rate" ? "rad/s" : "rad";
  records.training.response = signals.at(axis);
  const std::string other = axis == "roll" ? "pitch_cmd" : "roll_cmd";
  if (axis != "yaw_rate" && signals.has(other)) records.other_command = cleaned(signals.at(other));
  return records;
}

}  // namespace polyfly
