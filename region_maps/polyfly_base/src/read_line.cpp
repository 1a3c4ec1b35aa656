#include "polyfly_base/read_line.hpp"

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostCharacters = std::size_t{1} << 20;

}  // namespace

bool readLine(std::istream& stream, std::string& line, const std::string& path) {
  line.clear();
  std::streambuf& buffer = *stream.rdbuf();
  if (!stream) return false;
  for (;;) {
    const int next = buffer.sbumpc();
    if (next == std::char_traits<char>::eof()) {
      stream.setstate(line.empty() ? std::ios::eofbit | std::ios::failbit : std::ios::eofbit);
      return !line.empty();
    }
    if (next == '\n') return true;
    if (line.size() == kMostCharacters)
      throw Error(path + ": is not a text file: a line is longer than " + std::to_string(kMostCharacters) +
                  " characters");
    line += static_cast<char>(next);
  }
}

}  // namespace polyfly
