#include "region_maps/mapped_file.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

/// Closes the descriptor on every way out; the mapping does not need it.
struct Descriptor {
  int value = -1;
  ~Descriptor() {
    if (value >= 0) ::close(value);
  }
};

[[noreturn]] void refuse(const std::string& path, const std::string& reason) {
  throw Error(path + ": " + reason);
}

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  // O_NONBLOCK: a named pipe is refused below instead of waiting for its writer.
  const Descriptor file{::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)};
  if (file.value < 0) refuse(path, std::string("cannot be opened: ") + std::strerror(errno));
  struct stat info = {};
  if (::fstat(file.value, &info) != 0)
    refuse(path, std::string("cannot be examined: ") + std::strerror(errno));
  if (S_ISDIR(info.st_mode)) refuse(path, "is a directory, not a file");
  if (!S_ISREG(info.st_mode)) refuse(path, "is not a regular file");
  if (info.st_size == 0) refuse(path, "is empty");
  const auto size = static_cast<std::size_t>(info.st_size);
  // Not MAP_POPULATE: a file that is no map may be larger than memory, and a map's checksum reads every page.
  void* const data = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.value, 0);
  if (data == MAP_FAILED) refuse(path, std::string("cannot be mapped: ") + std::strerror(errno));
  data_ = data;
  size_ = size;
}

MappedFile::MappedFile(MappedFile&& other) noexcept
    : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}

MappedFile& MappedFile::operator=(MappedFile&& other) noexcept {
  std::swap(data_, other.data_);
  std::swap(size_, other.size_);
  return *this;
}

MappedFile::~MappedFile() {
  if (data_ != nullptr) ::munmap(data_, size_);
}

}  // namespace polyfly
