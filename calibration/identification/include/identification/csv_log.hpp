#pragma once

#include <map>
#include <string>
#include <vector>

namespace polyfly {

/// A flight as a table: the first line names the columns, a unit ends each name (`_rad`, `_deg`, `_s`, `_mps`
/// ...).
struct CsvLog {
  std::string path;
  /// Column names in the order of the file.
  std::vector<std::string> names;
  /// Values by column name. An empty or unreadable field is NaN.
  std::map<std::string, std::vector<double>> columns;
  std::size_t rows = 0;
  /// Number of fields that are neither a number nor empty.
  std::size_t unreadable = 0;
  /// Rows with fewer fields than names, as where a recording was cut off; left out.
  std::size_t cut_rows = 0;
  /// True: a comma stands before the decimals ("0,25"); only where fields are separated by another character.
  bool decimal_comma = false;

  bool has(const std::string& name) const { return columns.count(name) > 0; }
  /// Throws Error naming the file, the column, and the columns that there are.
  const std::vector<double>& column(const std::string& name) const;
};

/// Reads fields separated by comma, semicolon or tab; lines that begin with # are left out, and so is a byte
/// order mark of UTF-8. Throws Error naming file and rule: not there, empty, no header, a name twice, more
/// fields than names, no row, UTF-16.
CsvLog readCsv(const std::string& path);

}  // namespace polyfly
