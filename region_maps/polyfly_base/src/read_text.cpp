#include "polyfly_base/read_text.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

constexpr std::streamsize kMaxBytes = 64 * 1024 * 1024;  // far above any problem file; stops endless devices

}  // namespace

std::string readText(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw Error(path + ": file: must not be a directory");
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw Error(path + ": file: cannot be opened: " + std::strerror(errno));
  std::string text;
  std::string chunk(1 << 16, '\0');
  while (stream.read(&chunk[0], static_cast<std::streamsize>(chunk.size())), stream.gcount() > 0) {
    text.append(chunk, 0, static_cast<std::size_t>(stream.gcount()));
    if (static_cast<std::streamsize>(text.size()) > kMaxBytes) {
      throw Error(path + ": file: must not exceed " + std::to_string(kMaxBytes) + " bytes");
    }
  }
  if (stream.bad()) throw Error(path + ": file: cannot be read");
  const bool blank =
      std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) != 0; });
  if (blank) throw Error(path + ":1: file: must not be empty");
  return text;
}

bool endsWith(const std::string& text, const std::string& ending) {
  return text.size() >= ending.size() &&
         text.compare(text.size() - ending.size(), ending.size(), ending) == 0;
}

}  // namespace polyfly
