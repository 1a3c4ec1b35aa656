#include "polyfly_base/write_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "polyfly_base/error.hpp"
#include "polyfly_base/file_draft.hpp"
#include "polyfly_base/outputs.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kWrittenLast = 64;  ///< [bytes], see FORMAT.md on unfinished files
constexpr int kMaxAttempts = 1000;

std::string folderOf(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  if (slash == std::string::npos) return ".";
  return slash == 0 ? "/" : path.substr(0, slash);
}

/// So that the new name outlives a loss of power.
void syncFolder(const std::string& target) {
  const int descriptor = ::open(folderOf(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // a folder that may be written but not read: nothing can be synced
  ::fsync(descriptor);
  ::close(descriptor);
}

/// The standard output or error, where `path` is what it goes to; else the device or FIFO, opened.
int openStream(const std::string& path) {
  struct stat asked = {}, open = {};
  const bool there = ::stat(path.c_str(), &asked) == 0;
  for (const int descriptor : {STDOUT_FILENO, STDERR_FILENO}) {
    const bool same = there && ::fstat(descriptor, &open) == 0 && open.st_dev == asked.st_dev &&
                      open.st_ino == asked.st_ino;
    if (same) return ::fcntl(descriptor, F_DUPFD_CLOEXEC, 0);
  }
  return ::open(path.c_str(), O_WRONLY | O_NOCTTY | O_CLOEXEC);
}

void writeStream(const std::string& path, std::string_view text) {
  // Text that was printed before must come first.
  std::fflush(stdout);
  const int descriptor = openStream(path);
  bool good = descriptor >= 0;
  while (good && !text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    good = written > 0;
    if (good) text.remove_prefix(static_cast<std::size_t>(written));
  }
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (!good) throw Error(path + ": cannot be written: " + std::strerror(error));
}

void replaceFile(const std::string& path, std::string_view bytes) {
  FileDraft draft(path);
  const std::size_t head = std::min(kWrittenLast, bytes.size());
  draft.write(bytes.data() + head, head, bytes.size() - head);
  draft.sync();
  draft.write(bytes.data(), 0, head);
  draft.commit();
}

}  // namespace

FileDraft::FileDraft(const std::string& target) : name_(target), target_(followLinks(target)) {
  struct stat old = {};
  const bool replaces = ::stat(target_.c_str(), &old) == 0 && !S_ISDIR(old.st_mode);
  if (replaces && (!S_ISREG(old.st_mode) || isStream(target_)))
    throw Error(name_ + ": must be a file, not a device, a FIFO or the standard output");
  if (replaces && ::access(target_.c_str(), W_OK) != 0) fail("cannot be written");
  // A file without a name is gone when its writer is killed. Not every file system has such files.
  descriptor_ = ::open(folderOf(target_).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0666);
  if (descriptor_ >= 0) {
    path_ = "/proc/self/fd/" + std::to_string(descriptor_);
    if (::access(path_.c_str(), F_OK) != 0) ::close(std::exchange(descriptor_, -1));
  }
  if (descriptor_ >= 0) {
    const long longest = ::pathconf(folderOf(target_).c_str(), _PC_NAME_MAX);
    const std::string name = draftName(0);
    if (longest > 0 && name.size() - (name.rfind('/') + 1) > static_cast<std::size_t>(longest)) {
      ::close(descriptor_);
      errno = ENAMETOOLONG;
      fail("cannot be written");
    }
  } else {
    take([&] { return descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666); });
  }
  if (!replaces) return;
  // Who may read and write it stays, as far as the system lets this user say so.
  const bool kept = ::fchown(descriptor_, old.st_uid, old.st_gid) == 0;
  if (kept || old.st_uid == ::geteuid()) ::fchmod(descriptor_, old.st_mode & 0777);
}

FileDraft::~FileDraft() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (named_ && !renamed_) ::unlink(path_.c_str());
}

std::string FileDraft::draftName(int attempt) const {
  return target_ + ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
}

template <class Create>
void FileDraft::take(const Create& create) {
  // A writer that was killed may have left a file of the same name: take the next one.
  for (int attempt = 0; !named_; ++attempt) {
    path_ = draftName(attempt);
    named_ = create() >= 0;
    if (!named_ && (errno != EEXIST || attempt == kMaxAttempts)) fail("cannot be written");
  }
}

void FileDraft::write(const void* data, std::uint64_t offset, std::size_t bytes) {
  const auto* next = static_cast<const std::byte*>(data);
  while (bytes > 0) {
    const ssize_t written = ::pwrite(descriptor_, next, bytes, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) fail("cannot be written");
    next += written;
    offset += static_cast<std::uint64_t>(written);
    bytes -= static_cast<std::size_t>(written);
  }
}

void FileDraft::sync() {
  if (::fsync(descriptor_) != 0) fail("cannot be written to the disk");
}

void FileDraft::commit() {
  sync();
  if (!named_) {
    const std::string unnamed = path_;
    take([&] { return ::linkat(AT_FDCWD, unnamed.c_str(), AT_FDCWD, path_.c_str(), AT_SYMLINK_FOLLOW); });
  }
  const int result = ::close(descriptor_);
  descriptor_ = -1;
  if (result != 0) fail("cannot be written");
  if (::rename(path_.c_str(), target_.c_str()) != 0) fail("cannot be replaced");
  renamed_ = true;
  syncFolder(target_);
}

void FileDraft::fail(const char* what) const {
  throw Error(name_ + ": " + what + ": " + std::strerror(errno));
}

void writeFileAtomically(const std::string& path, const std::vector<std::byte>& bytes) {
  replaceFile(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void writeFileAtomically(const std::string& path, std::string_view text) {
  if (isStream(path)) return writeStream(path, text);
  replaceFile(path, text);
}

}  // namespace polyfly
