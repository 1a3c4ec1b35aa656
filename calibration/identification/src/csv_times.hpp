#pragma once

#include <map>
#include <string>
#include <vector>

#include "identification/csv_log.hpp"

namespace polyfly {

/// Times of the rows of a table.
struct CsvTimes {
  std::vector<double> seconds;
  /// Column, or columns of seconds and nanoseconds.
  std::string origin;
};

/// From the column that `choice` binds to time (`COLUMN`, `COLUMN:UNIT` or `SECONDS,NANOSECONDS`), or else
/// from one that is called t, time, timestamp or stamp. An ending _s, _ms, _us or _ns is the unit; without one they are
/// seconds. Throws Error naming file and columns.
CsvTimes timesOf(const CsvLog& log, const std::map<std::string, std::string>& choice);

/// Times of the commands, where they have some of their own (`cmd_time` in the choice, or `cmd_t_s`); empty
/// otherwise. Throws Error.
CsvTimes commandTimesOf(const CsvLog& log, const std::map<std::string, std::string>& choice);

}  // namespace polyfly
