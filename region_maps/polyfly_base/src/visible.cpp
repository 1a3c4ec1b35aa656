#include "polyfly_base/visible.hpp"

#include <cstdio>

#include "polyfly_base/utf8.hpp"

namespace polyfly {
namespace {

/// Of a well-formed sequence of three bytes: marks that turn the direction of text around (U+200E, 200F, 202A to 202E,
/// 2066 to 2069), and separators of lines (U+2028, 2029).
bool turnsText(unsigned char second, unsigned char third) noexcept {
  if (second == 0x80) return third == 0x8e || third == 0x8f || (third >= 0xa8 && third <= 0xae);
  return second == 0x81 && third >= 0xa6 && third <= 0xa9;
}

/// Of a well-formed sequence: C0, DEL, C1 (c2 80 to c2 9f in UTF-8), or what moves other text: those of turnsText, U+061C.
bool isControl(std::string_view sequence) noexcept {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(sequence[i]); };
  if (sequence.size() == 1) return byte(0) < 0x20 || byte(0) == 0x7f;
  if (sequence.size() == 2)
    return (byte(0) == 0xc2 && byte(1) < 0xa0) || (byte(0) == 0xd8 && byte(1) == 0x9c);
  return sequence.size() == 3 && byte(0) == 0xe2 && turnsText(byte(1), byte(2));
}

void appendEscaped(char character, std::string& result) {
  switch (character) {
    case '\n':
      result += "\\n";
      return;
    case '\r':
      result += "\\r";
      return;
    case '\t':
      result += "\\t";
      return;
    default:
      char escape[5];
      std::snprintf(escape, sizeof escape, "\\x%02x",
                    static_cast<unsigned>(static_cast<unsigned char>(character)));
      result += escape;
  }
}

}  // namespace

std::string visible(std::string_view text) {
  std::string result;
  while (!text.empty()) {
    const std::size_t length = sequenceLength(text);
    const std::string_view sequence = text.substr(0, length == 0 ? 1 : length);
    if (length == 0 || isControl(sequence)) {
      for (const char character : sequence) appendEscaped(character, result);
    } else {
      result += sequence;
    }
    text.remove_prefix(sequence.size());
  }
  return result;
}

std::string visibleLines(std::string_view text) {
  std::string result;
  for (;;) {
    const std::size_t end = text.find('\n');
    result += visible(text.substr(0, end));
    if (end == std::string_view::npos) return result;
    result += '\n';
    text.remove_prefix(end + 1);
  }
}

bool hasControl(std::string_view text) noexcept {
  while (!text.empty()) {
    const std::size_t length = sequenceLength(text);
    if (length > 0 && isControl(text.substr(0, length))) return true;
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return false;
}

}  // namespace polyfly
