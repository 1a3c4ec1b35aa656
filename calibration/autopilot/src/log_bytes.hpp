#pragma once

#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "autopilot/autopilot_log.hpp"
#include "bags/packed_number.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {

/// Whether a file begins with these bytes.
inline bool beginsWith(const std::string& path, const std::vector<std::uint8_t>& bytes) {
  std::vector<char> begin(bytes.size());
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return file.gcount() == static_cast<std::streamsize>(begin.size()) &&
         std::memcmp(begin.data(), bytes.data(), bytes.size()) == 0;
}

/// Adds a value to the last row of a table. Rows before it that lack the field hold NaN.
inline void addValue(const std::string& field, double value, LogTable* table) {
  std::vector<double>& column = table->column[field];
  column.resize(table->time.size() - 1, std::numeric_limits<double>::quiet_NaN());
  column.push_back(value);
}

/// Fills the columns of all tables up to their last row.
inline void fillColumns(AutopilotLog* log) {
  for (auto& [name, table] : log->tables) {
    for (auto& [field, column] : table.column)
      column.resize(table.time.size(), std::numeric_limits<double>::quiet_NaN());
  }
}

/// Forward reading of a file in pieces, with a look ahead.
class LogBytes {
 public:
  explicit LogBytes(const std::string& path) : file_(path, std::ios::binary) {
    if (!file_) throw Error(path + ": cannot be opened");
  }

  /// `size` bytes from here on, or nullptr where fewer are left; valid until the next call.
  const std::uint8_t* peek(std::size_t size) {
    if (end_ - begin_ < size && file_) fill(size);
    return end_ - begin_ < size ? nullptr : buffer_.data() + begin_;
  }
  void skip(std::size_t size) {
    begin_ += size;
    place_ += size;
  }
  /// Number of bytes before the current place.
  std::uint64_t place() const { return place_; }
  /// Number of bytes that are read ahead and still left. After a failed peek it covers the rest of the file.
  std::size_t left() const { return end_ - begin_; }

 private:
  void fill(std::size_t size) {
    constexpr std::size_t kPiece = 1 << 20;
    buffer_.erase(buffer_.begin(), buffer_.begin() + static_cast<std::ptrdiff_t>(begin_));
    end_ -= begin_;
    begin_ = 0;
    buffer_.resize(end_ + size + kPiece);
    file_.read(reinterpret_cast<char*>(buffer_.data() + end_), static_cast<std::streamsize>(size + kPiece));
    end_ += static_cast<std::size_t>(file_.gcount());
  }

  std::ifstream file_;
  std::vector<std::uint8_t> buffer_;
  std::size_t begin_ = 0;
  std::size_t end_ = 0;
  std::uint64_t place_ = 0;
};

}  // namespace polyfly
