#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace polyfly::test {

/// Writes bags of format 2.0 by hand, with all that recorders would not do.
class MadeBag {
 public:
  /// Returns the number of the new connection.
  std::uint32_t connect(const std::string& topic, const std::string& type, const std::string& definition);
  void write(std::uint32_t connection, double time, const std::vector<std::uint8_t>& bytes);
  void endChunk();
  /// The whole file, closed by its recorder or not.
  std::vector<std::uint8_t> bytes(bool closed = true);

 private:
  std::vector<std::uint8_t> file_;
  std::vector<std::uint8_t> chunk_;
  std::uint32_t connections_ = 0;
};

/// Bytes of a message, field by field.
class MessageBytes {
 public:
  template <class Number>
  MessageBytes& put(Number value) {
    const auto* raw = reinterpret_cast<const std::uint8_t*>(&value);
    bytes.insert(bytes.end(), raw, raw + sizeof value);
    return *this;
  }
  MessageBytes& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size()));
    bytes.insert(bytes.end(), value.begin(), value.end());
    return *this;
  }
  MessageBytes& header(double stamp) {
    const auto seconds = static_cast<std::uint32_t>(stamp);
    put(std::uint32_t{0}).put(seconds);
    return put(static_cast<std::uint32_t>((stamp - seconds) * 1e9)).text("world");
  }
  std::vector<std::uint8_t> bytes;
};

}  // namespace polyfly::test
