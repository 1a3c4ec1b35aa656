#pragma once

#include <cstdint>
#include <cstring>
#include <limits>

namespace polyfly {

/// A number at an address of any alignment; little-endian, as the formats of logs and this machine are.
template <class Number>
Number readNumber(const std::uint8_t* data) {
  Number number;
  std::memcpy(&number, data, sizeof number);
  return number;
}

/// The number of a type that Python's struct calls so: b B h H i I q Q f d. NaN for another letter.
inline double numberAt(const std::uint8_t* data, char type) {
  switch (type) {
    case 'b':
      return readNumber<std::int8_t>(data);
    case 'B':
      return *data;
    case 'h':
      return readNumber<std::int16_t>(data);
    case 'H':
      return readNumber<std::uint16_t>(data);
    case 'i':
      return readNumber<std::int32_t>(data);
    case 'I':
      return readNumber<std::uint32_t>(data);
    case 'q':
      return static_cast<double>(readNumber<std::int64_t>(data));
    case 'Q':
      return static_cast<double>(readNumber<std::uint64_t>(data));
    case 'f':
      return readNumber<float>(data);
    case 'd':
      return readNumber<double>(data);
    default:
      return std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace polyfly
