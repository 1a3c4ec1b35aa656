#include "files.hpp"

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

namespace checker {
namespace {

// Greatest size of a file that is read whole.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 33;

}  // namespace

void requireFile(const std::string& path) {
  std::error_code failure;
  const std::filesystem::file_status status = std::filesystem::status(path, failure);
  if (!std::filesystem::exists(status)) throw Unreadable(path + ": no such file");
  if (!std::filesystem::is_regular_file(status) && !std::filesystem::is_fifo(status))
    throw Unreadable(path + ": is no file");
}

std::string readFile(const std::string& path) {
  requireFile(path);
  // A pipe has no size, which counts as a failure.
  std::error_code failure;
  const std::uintmax_t size = std::filesystem::file_size(path, failure);
  if (!failure && size > kMostBytes)
    throw Unreadable(path + ": is larger than " + std::to_string(kMostBytes) + " bytes");
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content.exceptions(std::ios::badbit);  // else a stream keeps to itself that memory ran out
  try {
    content << file.rdbuf();
  } catch (const std::ios_base::failure&) {  // a folder, say
    file.setstate(std::ios::badbit);
  }
  if (!file.good() || !content.good()) throw Unreadable(path + ": cannot be read, or is empty");
  return content.str();
}

}  // namespace checker
