#pragma once

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

namespace polyfly {

/// Bytes that can be read from any place: a file, or memory.
class ByteSource {
 public:
  ByteSource() = default;
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;
  virtual ~ByteSource() = default;
  virtual std::uint64_t size() const = 0;
  /// Reads [from, from + count), which lies within the size. Returns whether it could.
  virtual bool read(std::uint64_t from, std::size_t count, std::uint8_t* out) = 0;
};

class MemorySource : public ByteSource {
 public:
  MemorySource(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  std::uint64_t size() const override { return size_; }
  bool read(std::uint64_t from, std::size_t count, std::uint8_t* out) override;

 private:
  // The caller owns these bytes.
  const std::uint8_t* data_;
  std::size_t size_;
};

/// Throws Error naming the file when it is not there or cannot be read.
class FileSource : public ByteSource {
 public:
  explicit FileSource(const std::string& path);
  std::uint64_t size() const override { return size_; }
  bool read(std::uint64_t from, std::size_t count, std::uint8_t* out) override;

 private:
  std::ifstream file_;
  std::uint64_t size_ = 0;
};

}  // namespace polyfly
