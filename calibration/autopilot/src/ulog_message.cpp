#include "ulog_message.hpp"

#include <algorithm>

namespace polyfly {
namespace {

bool isText(const std::uint8_t* data, std::size_t size) {
  return std::all_of(data, data + size, [](std::uint8_t byte) { return byte >= ' ' && byte < 127; });
}

// A text behind its length, which stands at a given place.
bool isKey(const std::uint8_t* data, std::size_t size, std::size_t place) {
  return size > place && data[place] > 0 && data[place] < size - place &&
         isText(data + place + 1, data[place]);
}

// What is told to a person: a level, and behind it any text, in any language.
bool isLogged(const std::uint8_t* data, std::size_t size, std::size_t text_at) {
  return size >= text_at && data[0] >= '0' && data[0] <= '7' &&
         std::all_of(data + text_at, data + size, [](std::uint8_t byte) { return byte >= '\t'; });
}

}  // namespace

bool isULogMessage(char type, const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kFlagBits = 40;
  constexpr std::size_t kSync = 8;
  constexpr std::size_t kNumber = 2;
  constexpr std::size_t kTextAt = 9;
  constexpr std::size_t kTaggedTextAt = 11;
  switch (type) {
    case 'B':
      return size == kFlagBits;
    case 'F':
      return size > 0 && isText(data, size);
    case 'I':
    case 'P':
      return isKey(data, size, 0);
    case 'M':
    case 'Q':
      return isKey(data, size, 1);
    case 'A':
      return size > 3 && isText(data + 3, size - 3);
    case 'R':
    case 'O':
      return size == kNumber;
    case 'L':
      return isLogged(data, size, kTextAt);
    case 'C':
      return isLogged(data, size, kTaggedTextAt);
    case 'S':
      return size == kSync;
    default:
      return false;
  }
}

}  // namespace polyfly
