#pragma once

#include <cstddef>
#include <cstdint>
#include <istream>
#include <memory>
#include <string>

namespace polyfly {

/// Bytes that can be read from any place: a file, or a copy in memory.
class ByteSource {
 public:
  /// Throws Error naming the file when it is not there or cannot be read.
  explicit ByteSource(const std::string& path);
  ByteSource(const std::uint8_t* data, std::size_t size);

  std::uint64_t size() const { return size_; }
  /// Reads [from, from + count), which lies within the size. Returns whether it could.
  bool read(std::uint64_t from, std::size_t count, std::uint8_t* out);

 private:
  std::unique_ptr<std::istream> bytes_;
  std::uint64_t size_ = 0;
};

}  // namespace polyfly
