#include <algorithm>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>

#include "identification/csv_log.hpp"
#include "identification/flight_signals.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

// How a signal may be called in a table: one of the stems, and one of the units behind it, - for none; any unit, or none,
// where there is no list. The first pattern that matches a column wins. `sign` turns z down into z up.
struct Pattern {
  const char* signal;
  const char* stems;
  const char* units;
  double sign = 1.0;
};

constexpr Pattern kPatterns[] = {
    {"roll_cmd", "roll_cmd roll_ref roll_sp roll_des", "rad deg"},
    {"pitch_cmd", "pitch_cmd pitch_ref pitch_sp pitch_des", "rad deg"},
    {"yaw_rate_cmd", "yaw_rate_cmd yawrate_cmd yaw_rate_ref yaw_rate_sp yaw_rate_des", "radps degps"},
    {"thrust_cmd",
     "thrust_cmd thrust_ref thrust_sp thrust_out throttle_cmd throttle_ref throttle_sp throttle_out", ""},
    {"roll", "roll roll_vicon roll_imu roll_est", "rad deg"},
    {"pitch", "pitch pitch_vicon pitch_imu pitch_est", "rad deg"},
    {"yaw", "yaw yaw_vicon yaw_imu yaw_est heading", "rad deg"},
    {"yaw_rate", "wz gz yaw_rate yawrate", "radps degps"},
    {"specific_force_z", "az", "mps2"},
    {"vx", "vx", "mps"},
    {"vy", "vy", "mps"},
    {"vz", "vz", "mps"},
    {"vz", "vd", "mps", -1.0},
    {"vn", "vn", "mps"},
    {"ve", "ve", "mps"},
    {"gyro_z", "gz", "radps degps"}};

constexpr Pattern kTimes[] = {{"time", "t", "s"}, {"time", "t time timestamp stamp", "- s ms us ns"}};

std::vector<std::string> wordsOf(const char* list) {
  std::istringstream words(list);
  return {std::istream_iterator<std::string>(words), {}};
}

bool matches(const Pattern& pattern, const std::string& column) {
  const std::vector<std::string> units = wordsOf(pattern.units);
  const auto allows = [&units](const std::string& unit) {
    return units.empty() || std::find(units.begin(), units.end(), unit) != units.end();
  };
  for (const std::string& stem : wordsOf(pattern.stems)) {
    if (column == stem && allows("-")) return true;
    if (column.compare(0, stem.size() + 1, stem + "_") == 0 && allows(column.substr(stem.size() + 1)))
      return true;
  }
  return false;
}

double unitOf(const std::string& column) {
  return endsWith(column, "_deg") || endsWith(column, "_degps") ? kRadiansPerDegree : 1.0;
}

std::string findColumn(const CsvLog& log, const Pattern& pattern) {
  const auto found = std::find_if(log.names.begin(), log.names.end(),
                                  [&pattern](const std::string& name) { return matches(pattern, name); });
  return found == log.names.end() ? std::string() : *found;
}

constexpr double kNanosecond = 1e-9;  // [s]

// None where it is no unit of time [s].
std::optional<double> secondsOf(const std::string& unit) {
  const std::map<std::string, double> seconds = {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", kNanosecond}};
  const auto found = seconds.find(unit);
  return found == seconds.end() ? std::nullopt : std::optional<double>(found->second);
}

// `COLUMN`, whose name may end with a unit, `COLUMN:UNIT`, or `SECONDS,NANOSECONDS`.
std::vector<double> timesAt(const CsvLog& log, const std::string& choice) {
  const std::size_t comma = choice.find(',');
  const std::size_t colon = choice.rfind(':');
  const std::string column = choice.substr(0, std::min(comma, colon));
  const std::size_t mark = colon == std::string::npos ? choice.rfind('_') : colon;
  std::optional<double> unit;
  if (mark != std::string::npos) unit = secondsOf(choice.substr(mark + 1));
  if (colon != std::string::npos && !unit)
    throw Error("--signal time=" + choice + ": its unit must be s, ms, us or ns");
  if (comma != std::string::npos) unit = 1.0;
  std::vector<double> times = log.column(column);
  for (double& time : times) time *= unit.value_or(1.0);
  if (comma == std::string::npos) return times;
  const std::vector<double>& rest = log.column(choice.substr(comma + 1));
  for (std::size_t i = 0; i < rest.size(); ++i) times[i] += kNanosecond * rest[i];
  return times;
}

// From the column that `choice` binds to time, or else from one that is called like a time. Throws Error naming file and
// columns.
std::vector<double> timesOf(const CsvLog& log, const std::map<std::string, std::string>& choice) {
  const auto chosen = choice.find("time");
  if (chosen != choice.end()) return timesAt(log, chosen->second);
  for (const Pattern& pattern : kTimes) {
    const std::string column = findColumn(log, pattern);
    if (!column.empty()) return timesAt(log, column);
  }
  throw Error(log.path + ": no column t_s; there are " + listOf(log.names) +
              "; name the times with --signal time=COLUMN, time=COLUMN:ms, or time=SECONDS,NANOSECONDS");
}

// Those of the commands; empty where they have none of their own. Throws Error.
std::vector<double> commandTimesOf(const CsvLog& log, const std::map<std::string, std::string>& choice) {
  const auto chosen = choice.find("cmd_time");
  if (chosen != choice.end()) return timesAt(log, chosen->second);
  return log.has("cmd_t_s") ? timesAt(log, "cmd_t_s") : std::vector<double>();
}

std::vector<std::string> remarksOn(const CsvLog& log) {
  std::vector<std::string> remarks;
  if (log.decimal_comma) remarks.emplace_back("its numbers have a decimal comma");
  if (log.unreadable > 0)
    remarks.push_back(std::to_string(log.unreadable) + " fields are neither a number nor empty");
  if (log.cut_rows > 0)
    remarks.push_back(std::to_string(log.cut_rows) + " rows have too few fields and were left out");
  return remarks;
}

}  // namespace

const std::vector<std::string>& signalNames() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> list;
    for (const Pattern& pattern : kPatterns) {
      if (std::find(list.begin(), list.end(), pattern.signal) == list.end())
        list.emplace_back(pattern.signal);
    }
    return list;
  }();
  return kNames;
}

FlightSignals signalsFromCsv(const CsvLog& log, const std::map<std::string, std::string>& choice) {
  FlightSignals signals;
  signals.source = log.path;
  signals.remarks = remarksOn(log);
  signals.places = log.names;
  const std::vector<double> all_times = timesOf(log, choice);
  const std::vector<double> command_times = commandTimesOf(log, choice);
  const auto add = [&](const std::string& signal, const std::string& column, double factor) {
    // Commands with times of their own are logged as they came; held onto other rows they repeat.
    const bool own_time = signal.find("_cmd") != std::string::npos && !command_times.empty();
    const std::vector<double>& times = own_time ? command_times : all_times;
    const std::vector<double>& values = log.column(column);
    TimeSeries& series = signals.series[signal];
    for (std::size_t i = 0; i < times.size(); ++i) {
      if (own_time && !series.time.empty() && times[i] == series.time.back()) continue;
      series.time.push_back(times[i]);
      series.value.push_back(factor * values[i]);
    }
    signals.origin[signal] = column;
  };
  for (const auto& [signal, column] : choice) {
    if (signal == "time" || signal == "cmd_time") continue;
    const ChosenPlace chosen = chosenPlace(signal, column);
    add(signal, chosen.place, chosen.sign * (chosen.in_degrees ? kRadiansPerDegree : unitOf(chosen.place)));
    signals.origin[signal] = column;
  }
  for (const Pattern& pattern : kPatterns) {
    const std::string column = findColumn(log, pattern);
    if (!signals.has(pattern.signal) && !column.empty())
      add(pattern.signal, column, pattern.sign * unitOf(column));
  }
  return signals;
}

}  // namespace polyfly
