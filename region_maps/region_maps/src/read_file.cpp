#include "region_maps/read_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

/// A file that is open, closed on every way out.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path)
      // O_NONBLOCK: a named pipe is refused later instead of waiting for its writer.
      : path_(path), descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
    if (descriptor_ < 0) failWithReason("cannot be opened");
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() { ::close(descriptor_); }

  [[noreturn]] void fail(const std::string& rule) const { throw Error(path_ + ": " + rule); }

  struct stat examine() const {
    struct stat info = {};
    if (::fstat(descriptor_, &info) != 0) failWithReason("cannot be examined");
    return info;
  }

  /// The next `size` bytes. Fails where the file ends before.
  void read(std::byte* place, std::size_t size) const {
    while (size > 0) {
      const ssize_t count = ::read(descriptor_, place, size);
      if (count < 0 && errno == EINTR) continue;
      if (count < 0) failWithReason("cannot be read");
      if (count == 0) fail("became shorter while it was read");
      place += count;
      size -= static_cast<std::size_t>(count);
    }
  }

 private:
  [[noreturn]] void failWithReason(const char* what) const {
    fail(std::string(what) + ": " + std::strerror(errno));
  }

  const std::string& path_;
  int descriptor_;
};

bool isSame(const struct stat& a, const struct stat& b) {
  return a.st_size == b.st_size && a.st_mtim.tv_sec == b.st_mtim.tv_sec &&
         a.st_mtim.tv_nsec == b.st_mtim.tv_nsec;
}

AlignedBytes memoryFor(const OpenFile& file, std::size_t size) try {
  return AlignedBytes(size);
} catch (const std::bad_alloc&) {
  file.fail("does not fit into memory: " + std::to_string(size) + " bytes");
}

}  // namespace

AlignedBytes readFile(const std::string& path, const HeadCheck& check_head) {
  const OpenFile file(path);
  const struct stat before = file.examine();
  if (S_ISDIR(before.st_mode)) file.fail("is a directory, not a file");
  if (!S_ISREG(before.st_mode)) file.fail("is not a regular file");
  if (before.st_size == 0) file.fail("is empty");
  const auto size = static_cast<std::size_t>(before.st_size);
  std::byte head[kHeadBytes];
  const std::size_t head_size = std::min(size, kHeadBytes);
  file.read(head, head_size);
  check_head(head, size);
  AlignedBytes bytes = memoryFor(file, size);
  std::copy(head, head + head_size, bytes.data());
  file.read(bytes.data() + head_size, size - head_size);
  if (!isSame(before, file.examine())) file.fail("changed while it was read");
  return bytes;
}

}  // namespace polyfly
