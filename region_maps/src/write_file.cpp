#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "region_maps/error.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kWrittenLast = 64;  ///< [bytes], see FORMAT.md on unfinished files
constexpr int kMaxAttempts = 1000;

std::string folderOf(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

/// A new file beside its target: removed again unless it was renamed.
class Draft {
 public:
  explicit Draft(const std::string& target) : target_(target) {
    // A writer that was killed may have left a file of the same name: take the next one.
    for (int attempt = 0; descriptor_ < 0; ++attempt) {
      path_ = target + ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
      descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ < 0 && (errno != EEXIST || attempt == kMaxAttempts)) fail("cannot be written");
    }
  }
  Draft(const Draft&) = delete;
  Draft& operator=(const Draft&) = delete;
  ~Draft() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!renamed_) ::unlink(path_.c_str());
  }

  void write(const std::byte* data, std::size_t first, std::size_t end) {
    while (first < end) {
      const ssize_t written = ::pwrite(descriptor_, data + first, end - first, static_cast<off_t>(first));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) fail("cannot be written");
      first += static_cast<std::size_t>(written);
    }
  }

  void sync() {
    if (::fsync(descriptor_) != 0) fail("cannot be written to the disk");
  }

  void rename() {
    const int result = ::close(descriptor_);
    descriptor_ = -1;
    if (result != 0) fail("cannot be written");
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail("cannot be replaced");
    renamed_ = true;
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    throw Error(target_ + ": " + what + ": " + std::strerror(errno));
  }

  const std::string target_;
  std::string path_;
  int descriptor_ = -1;
  bool renamed_ = false;
};

/// So that the new name outlives a loss of power.
void syncFolder(const std::string& target) {
  const int descriptor = ::open(folderOf(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // a folder that may be written but not read: nothing can be synced
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

void writeFileAtomically(const std::string& path, const std::vector<std::byte>& bytes) {
  Draft draft(path);
  const std::size_t head = std::min(kWrittenLast, bytes.size());
  draft.write(bytes.data(), head, bytes.size());
  draft.sync();
  draft.write(bytes.data(), 0, head);
  draft.sync();
  draft.rename();
  syncFolder(path);
}

}  // namespace polyfly
