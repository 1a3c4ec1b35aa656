#include "byte_source.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "polyfly_base/error.hpp"

namespace polyfly {

bool MemorySource::read(std::uint64_t from, std::size_t count, std::uint8_t* out) {
  std::copy_n(data_ + from, count, out);
  return true;
}

FileSource::FileSource(const std::string& path) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure)) throw Error(path + ": no such file");
  if (!std::filesystem::is_regular_file(path, failure)) throw Error(path + ": not a file");
  size_ = std::filesystem::file_size(path, failure);
  if (failure) throw Error(path + ": cannot be read: " + failure.message());
  file_.open(path, std::ios::binary);
  if (!file_) throw Error(path + ": cannot be read");
}

bool FileSource::read(std::uint64_t from, std::size_t count, std::uint8_t* out) {
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(from));
  file_.read(reinterpret_cast<char*>(out), static_cast<std::streamsize>(count));
  return static_cast<bool>(file_);
}

}  // namespace polyfly
