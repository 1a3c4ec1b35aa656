#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "polyfly_base/error.hpp"

namespace polyfly {

/// Appends plain values as they lie in memory.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  template <typename T>
  void put(const T& value) {
    putArray(&value, 1);
  }
  template <typename T>
  void putArray(const T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* const first = reinterpret_cast<const std::byte*>(values);
    bytes_.insert(bytes_.end(), first, first + count * sizeof(T));
  }

 private:
  std::vector<std::byte>& bytes_;
};

/// Reads what ByteWriter wrote. The bytes belong to someone else. Throws Error, "NAME: is cut off", where
/// they end too early.
class ByteReader {
 public:
  ByteReader(const std::byte* data, std::size_t size, std::string name)
      : next_(data), left_(size), name_(std::move(name)) {}

  template <typename T>
  T get() {
    T value;
    getArray(&value, 1);
    return value;
  }
  template <typename T>
  void getArray(T* values, std::size_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    need(count, sizeof(T));
    if (count == 0) return;
    // To GCC 9, a type is safe to copy as bytes only if it also has a trivial constructor.
    std::memcpy(static_cast<void*>(values), next_, count * sizeof(T));
    next_ += count * sizeof(T);
    left_ -= count * sizeof(T);
  }

  /// Throws Error when fewer than `count` values of `size` bytes are left.
  void need(std::size_t count, std::size_t size) const {
    if (count > left_ / size) throw Error(name_ + ": is cut off");
  }
  void skip(std::size_t bytes) {
    need(bytes, 1);
    next_ += bytes;
    left_ -= bytes;
  }
  const std::byte* next() const { return next_; }
  std::size_t left() const { return left_; }

 private:
  const std::byte* next_;
  std::size_t left_;
  std::string name_;
};

}  // namespace polyfly
