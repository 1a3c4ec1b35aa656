#include "csv_times.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "identification/loop_record.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

struct TimeUnit {
  const char* ending;
  const char* name;
  double seconds;
};
constexpr TimeUnit kTimeUnits[] = {{"s", "seconds", 1.0},
                                   {"ms", "milliseconds", 1e-3},
                                   {"us", "microseconds", 1e-6},
                                   {"ns", "nanoseconds", 1e-9}};
constexpr const char* kTimeStems[] = {"t", "time", "timestamp", "stamp"};
// Time between the rows of a usual flight log [s].
constexpr double kUsualPeriod = 0.02;
constexpr double kNanosecond = 1e-9;  // [s]

// The unit at the end of the name, or none.
const TimeUnit* namedUnit(const std::string& column) {
  const std::size_t underscore = column.rfind('_');
  if (underscore == std::string::npos) return nullptr;
  for (const TimeUnit& unit : kTimeUnits) {
    if (column.compare(underscore + 1, std::string::npos, unit.ending) == 0) return &unit;
  }
  return nullptr;
}

const TimeUnit* likelyUnit(double period) {
  const TimeUnit* best = std::begin(kTimeUnits);
  if (!(period > 0.0)) return best;
  const auto distance = [period](const TimeUnit& unit) {
    return std::abs(std::log(period * unit.seconds / kUsualPeriod));
  };
  for (const TimeUnit& unit : kTimeUnits) {
    if (distance(unit) < distance(*best)) best = &unit;
  }
  return best;
}

CsvTimes ofColumn(const CsvLog& log, const std::string& column) {
  CsvTimes times;
  times.origin = column;
  times.seconds = log.column(column);
  const TimeUnit* unit = namedUnit(column);
  if (unit == nullptr) {
    const TimeSeries clean = cleaned({times.seconds, times.seconds});
    const double period = typicalPeriod(clean);
    unit = likelyUnit(period);
    char text[160];
    std::snprintf(text, sizeof text, " are taken as %s: %.6g between rows", unit->name, period);
    times.remark = "the times of column " + column + text;
  }
  for (double& time : times.seconds) time *= unit->seconds;
  return times;
}

CsvTimes ofChoice(const CsvLog& log, const std::string& choice) {
  const std::size_t comma = choice.find(',');
  if (comma == std::string::npos) return ofColumn(log, choice);
  CsvTimes times;
  times.origin = choice;
  times.seconds = log.column(choice.substr(0, comma));
  const std::vector<double>& rest = log.column(choice.substr(comma + 1));
  for (std::size_t i = 0; i < rest.size(); ++i) times.seconds[i] += kNanosecond * rest[i];
  return times;
}

bool isTimeName(const std::string& column) {
  return std::any_of(std::begin(kTimeStems), std::end(kTimeStems), [&column](const std::string stem) {
    if (column == stem) return true;
    return column.compare(0, stem.size() + 1, stem + "_") == 0 && namedUnit(column) != nullptr &&
           column.rfind('_') == stem.size();
  });
}

}  // namespace

CsvTimes timesOf(const CsvLog& log, const std::map<std::string, std::string>& choice) {
  const auto chosen = choice.find("time");
  if (chosen != choice.end()) return ofChoice(log, chosen->second);
  if (log.has("t_s")) return ofColumn(log, "t_s");
  const auto found = std::find_if(log.names.begin(), log.names.end(), isTimeName);
  if (found != log.names.end()) return ofColumn(log, *found);
  std::string known;
  for (const std::string& name : log.names) known += (known.empty() ? "" : ", ") + name;
  throw Error(log.path + ": no column t_s; there are " + known +
              "; name the times with --signal time=COLUMN, or time=SECONDS,NANOSECONDS");
}

CsvTimes commandTimesOf(const CsvLog& log, const std::map<std::string, std::string>& choice) {
  const auto chosen = choice.find("cmd_time");
  if (chosen != choice.end()) return ofChoice(log, chosen->second);
  if (log.has("cmd_t_s")) return ofColumn(log, "cmd_t_s");
  return {};
}

}  // namespace polyfly
