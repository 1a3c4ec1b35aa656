#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace polyfly {

/// A new file beside its target that takes the target's place when it is complete. Readers see the old bytes or the
/// new ones, also after a loss of power. It has no name until then, and is gone unless it was committed. Where a file system
/// needs names, a writer that was killed leaves TARGET.tmp-* behind. For what is too long for writeFileAtomically's one piece. Where the target is a symbolic
/// link, the file behind it is replaced; who may read a file stays as it was. Everything throws Error, also for a
/// target that is there and no file.
class FileDraft {
 public:
  explicit FileDraft(const std::string& target);
  FileDraft(const FileDraft&) = delete;
  FileDraft& operator=(const FileDraft&) = delete;
  ~FileDraft();

  /// Writes at `offset`, in any order.
  void write(const void* data, std::uint64_t offset, std::size_t bytes);

  /// Brings what was written so far to the disk.
  void sync();

  /// Where the new file is meanwhile.
  const std::string& path() const { return path_; }

  /// Syncs, renames, syncs the folder. Nothing else may follow.
  void commit();

 private:
  [[noreturn]] void fail(const char* what) const;
  std::string draftName(int attempt) const;
  /// Gives the draft the first name at which `create` succeeds.
  template <class Create>
  void take(const Create& create);

  // Name of the target as the caller gives it.
  const std::string name_;
  // Path of the target behind links.
  const std::string target_;
  std::string path_;
  int descriptor_ = -1;
  bool named_ = false, renamed_ = false;
};

}  // namespace polyfly
