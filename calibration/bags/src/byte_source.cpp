#include "byte_source.hpp"

#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>

#include "polyfly_base/error.hpp"

namespace polyfly {

ByteSource::ByteSource(const std::string& path) {
  std::error_code failure;
  if (!std::filesystem::exists(path, failure)) throw Error(path + ": no such file");
  if (!std::filesystem::is_regular_file(path, failure)) throw Error(path + ": not a file");
  size_ = std::filesystem::file_size(path, failure);
  if (failure) throw Error(path + ": cannot be read: " + failure.message());
  bytes_ = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*bytes_) throw Error(path + ": cannot be read");
}

ByteSource::ByteSource(const std::uint8_t* data, std::size_t size)
    : bytes_(std::make_unique<std::istringstream>(std::string(reinterpret_cast<const char*>(data), size))),
      size_(size) {}

bool ByteSource::read(std::uint64_t from, std::size_t count, std::uint8_t* out) {
  bytes_->clear();
  bytes_->seekg(static_cast<std::streamoff>(from));
  bytes_->read(reinterpret_cast<char*>(out), static_cast<std::streamsize>(count));
  return static_cast<bool>(*bytes_);
}

}  // namespace polyfly
