#include "csv.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <optional>

#include "polyfly_base/error.hpp"
#include "polyfly_base/read_line.hpp"

namespace polyfly {
namespace {

std::vector<std::string> cells(const std::string& line) {
  std::vector<std::string> result;
  std::size_t begin = 0;
  while (true) {
    const std::size_t comma = std::min(line.find(',', begin), line.size());
    const std::size_t first = std::min(line.find_first_not_of(" \t\r", begin), comma);
    std::size_t last = comma;
    while (last > first && (line[last - 1] == ' ' || line[last - 1] == '\t' || line[last - 1] == '\r'))
      --last;
    result.push_back(line.substr(first, last - first));
    if (comma == line.size()) return result;
    begin = comma + 1;
  }
}

std::optional<double> number(const std::string& cell) {
  if (cell.empty()) return std::nullopt;
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (*end != '\0') return std::nullopt;
  return value;
}

class Reader {
 public:
  Reader(const std::string& path, const std::vector<std::string>& names) : path_(path), names_(names) {
    for (std::size_t i = 0; i < names.size(); ++i) column_of_.push_back(i);
  }

  void readLine(const std::string& line) {
    ++line_;
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') return;
    const std::vector<std::string> row = cells(line);
    if (!started_) {
      started_ = true;
      if (isHeader(row)) {
        readHeader(row);
        return;
      }
    }
    readNumbers(row);
  }

  std::vector<std::vector<double>> take() { return std::move(rows_); }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(path_ + ":" + std::to_string(line_) + ": " + what);
  }

  // One parameter's name is enough: the rest is then checked as names.
  bool isHeader(const std::vector<std::string>& row) const {
    return std::any_of(row.begin(), row.end(), [this](const std::string& cell) {
      return std::find(names_.begin(), names_.end(), cell) != names_.end();
    });
  }

  void readHeader(const std::vector<std::string>& row) {
    for (std::size_t column = 0; column < row.size(); ++column) {
      const std::string where = "column " + std::to_string(column + 1) + ": ";
      if (std::find(names_.begin(), names_.end(), row[column]) == names_.end()) {
        fail(where + "'" + row[column] + "' is not a parameter of the map");
      }
      if (std::find(row.begin(), row.begin() + static_cast<std::ptrdiff_t>(column), row[column]) !=
          row.begin() + static_cast<std::ptrdiff_t>(column)) {
        fail(where + "'" + row[column] + "' is given twice");
      }
    }
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const auto found = std::find(row.begin(), row.end(), names_[i]);
      if (found == row.end()) fail("no column for the parameter '" + names_[i] + "'");
      column_of_[i] = static_cast<std::size_t>(found - row.begin());
    }
  }

  void readNumbers(const std::vector<std::string>& row) {
    if (row.size() != names_.size()) {
      fail("must have " + std::to_string(names_.size()) + " columns, got " + std::to_string(row.size()));
    }
    std::vector<double> theta(names_.size());
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const std::string& cell = row[column_of_[i]];
      const std::optional<double> value = number(cell);
      if (!value) {
        fail("column " + std::to_string(column_of_[i] + 1) + " '" + names_[i] + "': '" + cell +
             "' is not a number");
      }
      theta[i] = *value;
    }
    rows_.push_back(std::move(theta));
  }

  const std::string& path_;
  const std::vector<std::string>& names_;
  // Column of each parameter.
  std::vector<std::size_t> column_of_;
  std::vector<std::vector<double>> rows_;
  std::size_t line_ = 0;
  bool started_ = false;
};

}  // namespace

std::vector<std::vector<double>> readCsv(const std::string& path, const std::vector<std::string>& names) {
  std::ifstream file(path);
  if (!file) throw Error(path + ": cannot be read");
  Reader reader(path, names);
  std::string line;
  while (polyfly::readLine(file, line, path)) reader.readLine(line);
  if (file.bad()) throw Error(path + ": cannot be read");
  return reader.take();
}

}  // namespace polyfly
