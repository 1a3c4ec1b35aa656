#include "csv_times.hpp"

#include <algorithm>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

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
CsvTimes ofColumn(const CsvLog& log, const std::string& choice) {
  const std::size_t colon = choice.rfind(':');
  const std::string column = choice.substr(0, colon);
  CsvTimes times;
  times.origin = choice;
  times.seconds = log.column(column);
  const TimeUnit* unit = colon == std::string::npos ? namedUnit(column) : timeUnit(choice.substr(colon + 1));
  if (colon != std::string::npos && unit == nullptr)
    throw Error("--signal time=" + choice + ": its unit must be s, ms, us or ns");
  for (double& time : times.seconds) time *= unit == nullptr ? 1.0 : unit->seconds;
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
              "; name the times with --signal time=COLUMN, time=COLUMN:ms, or time=SECONDS,NANOSECONDS");
}

CsvTimes commandTimesOf(const CsvLog& log, const std::map<std::string, std::string>& choice) {
  const auto chosen = choice.find("cmd_time");
  if (chosen != choice.end()) return ofChoice(log, chosen->second);
  if (log.has("cmd_t_s")) return ofColumn(log, "cmd_t_s");
  return {};
}

}  // namespace polyfly
