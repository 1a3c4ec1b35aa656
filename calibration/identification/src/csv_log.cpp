#include "identification/csv_log.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string_view>

#include "polyfly_base/decimal.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_line.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t\r\"";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> fields(std::string_view line, char separator) {
  std::vector<std::string_view> found;
  while (true) {
    const std::size_t end = line.find(separator);
    found.push_back(trimmed(line.substr(0, end)));
    if (end == std::string_view::npos) return found;
    line.remove_prefix(end + 1);
  }
}

char separatorOf(const std::string& header) {
  const auto most = [&header](char one, char other) {
    return std::count(header.begin(), header.end(), one) >= std::count(header.begin(), header.end(), other)
               ? one
               : other;
  };
  return most(',', most(';', '\t'));
}

// A number, or NaN; `bad` counts what is neither a number nor empty.
double valueOf(std::string_view text, CsvLog* log) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  if (text.empty()) return kNan;
  std::string number(text);
  // Only where another character separates the fields can a comma get here.
  const std::size_t comma = number.find(',');
  if (comma != std::string::npos) number[comma] = '.';
  const std::optional<double> value = numberOf(number);
  if (value)
    log->decimal_comma = log->decimal_comma || comma != std::string::npos;
  else
    ++log->unreadable;
  return value.value_or(kNan);
}

// Passes the byte order mark that some programs write.
void passMark(std::istream& file, const std::string& path) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  std::string start(kMark.size(), '\0');
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  file.clear();
  const std::string_view pair = std::string_view(start).substr(0, 2);
  if (pair == "\xff\xfe" || pair == "\xfe\xff") throw Error(path + ": is UTF-16; save it as UTF-8");
  if (start != kMark) file.seekg(0);
}

bool nextLine(std::istream& file, std::string* line, const std::string& path) {
  while (readLine(file, *line, path)) {
    const std::string_view content = trimmed(*line);
    if (!content.empty() && content.front() != '#') return true;
  }
  return false;
}

}  // namespace

const std::vector<double>& CsvLog::column(const std::string& name) const {
  const auto found = columns.find(name);
  if (found != columns.end()) return found->second;
  throw Error(path + ": no column " + name + "; there are " + listOf(names));
}

CsvLog readCsv(const std::string& path) {
  std::error_code failure;
  if (!std::filesystem::is_regular_file(path, failure)) throw Error(path + ": no such file");
  std::ifstream file(path);
  if (!file) throw Error(path + ": cannot be read");
  passMark(file, path);
  std::string line;
  if (!nextLine(file, &line, path)) throw Error(path + ": is empty");
  CsvLog log;
  log.path = path;
  const char separator = separatorOf(line);
  std::vector<std::vector<double>> columns;
  for (const std::string_view name : fields(line, separator)) log.names.emplace_back(name);
  columns.resize(log.names.size());
  std::size_t number = 1;
  while (nextLine(file, &line, path)) {
    ++number;
    const std::vector<std::string_view> row = fields(line, separator);
    if (row.size() > log.names.size()) {
      throw Error(path + ": row " + std::to_string(number) + ": has " + std::to_string(row.size()) +
                  " fields, the header names " + std::to_string(log.names.size()) +
                  (separator == ',' ? "; with decimal commas, separate the fields by semicolons" : ""));
    }
    if (row.size() < log.names.size()) {
      ++log.cut_rows;
      continue;
    }
    for (std::size_t i = 0; i < row.size(); ++i) columns[i].push_back(valueOf(row[i], &log));
    ++log.rows;
  }
  for (std::size_t i = 0; i < log.names.size(); ++i) {
    if (log.names[i].empty()) throw Error(path + ": column " + std::to_string(i + 1) + " has no name");
    if (!log.columns.emplace(log.names[i], std::move(columns[i])).second) {
      throw Error(path + ": two columns are called " + log.names[i]);
    }
  }
  if (log.rows == 0) throw Error(path + ": has no row of numbers");
  return log;
}

}  // namespace polyfly
