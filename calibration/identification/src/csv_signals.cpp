#include <algorithm>
#include <iterator>
#include <sstream>

#include "identification/csv_log.hpp"
#include "identification/flight_signals.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"

namespace polyfly {
namespace {

// How a signal may be called in a table: one of the stems, and one of the units behind it; any unit, or none, where there
// is no list. The first pattern that matches a column wins. `sign` turns z down into z up.
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

std::vector<std::string> wordsOf(const char* list) {
  std::istringstream words(list);
  return {std::istream_iterator<std::string>(words), {}};
}

bool matches(const Pattern& pattern, const std::string& column) {
  const std::vector<std::string> units = wordsOf(pattern.units);
  for (const std::string& stem : wordsOf(pattern.stems)) {
    if (column == stem) return units.empty();
    if (column.compare(0, stem.size() + 1, stem + "_") != 0) continue;
    if (units.empty()) return true;
    if (std::find(units.begin(), units.end(), column.substr(stem.size() + 1)) != units.end()) return true;
  }
  return false;
}

double unitOf(const std::string& column) {
  return endsWith(column, "_deg") || endsWith(column, "_degps") ? kRadiansPerDegree : 1.0;
}

struct TimeUnit {
  const char* ending;
  double seconds;
};
constexpr TimeUnit kTimeUnits[] = {{"s", 1.0}, {"ms", 1e-3}, {"us", 1e-6}, {"ns", 1e-9}};
constexpr const char* kTimeStems[] = {"t", "time", "timestamp", "stamp"};
constexpr double kNanosecond = 1e-9;  // [s]

const TimeUnit* timeUnit(const std::string& ending) {
  for (const TimeUnit& unit : kTimeUnits) {
    if (ending == unit.ending) return &unit;
  }
  return nullptr;
}

// The unit at the end of the name, or none.
const TimeUnit* namedUnit(const std::string& column) {
  const std::size_t underscore = column.rfind('_');
  if (underscore == std::string::npos) return nullptr;
  return timeUnit(column.substr(underscore + 1));
}

// A column, or `COLUMN:UNIT`.
std::vector<double> ofColumn(const CsvLog& log, const std::string& choice) {
  const std::size_t colon = choice.rfind(':');
  const std::string column = choice.substr(0, colon);
  std::vector<double> times = log.column(column);
  const TimeUnit* unit = colon == std::string::npos ? namedUnit(column) : timeUnit(choice.substr(colon + 1));
  if (colon != std::string::npos && unit == nullptr)
    throw Error("--signal time=" + choice + ": its unit must be s, ms, us or ns");
  for (double& time : times) time *= unit == nullptr ? 1.0 : unit->seconds;
  return times;
}

std::vector<double> ofChoice(const CsvLog& log, const std::string& choice) {
  const std::size_t comma = choice.find(',');
  if (comma == std::string::npos) return ofColumn(log, choice);
  std::vector<double> times = log.column(choice.substr(0, comma));
  const std::vector<double>& rest = log.column(choice.substr(comma + 1));
  for (std::size_t i = 0; i < rest.size(); ++i) times[i] += kNanosecond * rest[i];
  return times;
}

bool isTimeName(const std::string& column) {
  return std::any_of(std::begin(kTimeStems), std::end(kTimeStems), [&column](const std::string stem) {
    if (column == stem) return true;
    return column.compare(0, stem.size() + 1, stem + "_") == 0 && namedUnit(column) != nullptr &&
           column.rfind('_') == stem.size();
  });
}

// From the column that `choice` binds to time, or else from one that is called like a time. Throws Error naming file and
// columns.
std::vector<double> timesOf(const CsvLog& log, const std::map<std::string, std::string>& choice) {
  const auto chosen = choice.find("time");
  if (chosen != choice.end()) return ofChoice(log, chosen->second);
  if (log.has("t_s")) return ofColumn(log, "t_s");
  const auto found = std::find_if(log.names.begin(), log.names.end(), isTimeName);
  if (found != log.names.end()) return ofColumn(log, *found);
  std::string known;
  for (const std::string& name : log.names) known += (known.empty() ? "" : ", ") + name;
  throw Error(log.path + ": no column t_s; there are " + known +
              "; name the times with --signal time=COLUMN, time=COLUMN:ms, or time=SECONDS,NANOSECONDS");
}

// Empty where the commands have none of their own. Throws Error.
std::vector<double> commandTimesOf(const CsvLog& log, const std::map<std::string, std::string>& choice) {
  const auto chosen = choice.find("cmd_time");
  if (chosen != choice.end()) return ofChoice(log, chosen->second);
  if (log.has("cmd_t_s")) return ofColumn(log, "cmd_t_s");
  return {};
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
  std::vector<double> times_;
  std::vector<double> command_times_;
};

TimeSeries CsvColumns::series(const std::string& signal, const std::string& column, double sign) const {
  const bool own_time = isCommand(signal) && !command_times_.empty();
  const std::vector<double>& times = own_time ? command_times_ : times_;
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
  for (const Pattern& pattern : kPatterns) {
    if (signals.has(pattern.signal)) continue;
    const std::string column = findColumn(log, pattern);
    if (column.empty()) continue;
    signals.series[pattern.signal] = columns.series(pattern.signal, column, pattern.sign);
    signals.origin[pattern.signal] = column;
  }
  return signals;
}

}  // namespace polyfly
