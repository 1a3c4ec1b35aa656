#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "region_maps/error.hpp"
#include "region_maps/file_draft.hpp"
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

/// So that the new name outlives a loss of power.
void syncFolder(const std::string& target) {
  const int descriptor = ::open(folderOf(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;  // a folder that may be written but not read: nothing can be synced
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

FileDraft::FileDraft(const std::string& target) : target_(target) {
  // A writer that was killed may have left a file of the same name: take the next one.
  for (int attempt = 0; descriptor_ < 0; ++attempt) {
    path_ = target + ".tmp-" + std::to_string(::getpid()) + "-" + std::to_string(attempt);
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && (errno != EEXIST || attempt == kMaxAttempts)) fail("cannot be written");
  }
}

FileDraft::~FileDraft() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (!renamed_) ::unlink(path_.c_str());
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
  const int result = ::close(descriptor_);
  descriptor_ = -1;
  if (result != 0) fail("cannot be written");
  if (::rename(path_.c_str(), target_.c_str()) != 0) fail("cannot be replaced");
  renamed_ = true;
  syncFolder(target_);
}

void FileDraft::fail(const char* what) const {
  throw Error(target_ + ": " + what + ": " + std::strerror(errno));
}

void writeFileAtomically(const std::string& path, std::string_view text) {
  FileDraft draft(path);
  const std::size_t head = std::min(kWrittenLast, text.size());
  draft.write(text.data() + head, head, text.size() - head);
  draft.sync();
  draft.write(text.data(), 0, head);
  draft.commit();
}

void writeFileAtomically(const std::string& path, const std::vector<std::byte>& bytes) {
  writeFileAtomically(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace polyfly
