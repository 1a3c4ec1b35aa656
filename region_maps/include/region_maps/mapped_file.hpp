#pragma once

#include <cstddef>
#include <string>

namespace polyfly {

/// A file mapped into memory, read-only, for as long as the object lives. Page aligned. Moves, does not copy.
class MappedFile {
 public:
  MappedFile() noexcept = default;

  /// Throws Error when the file is missing, unreadable, empty or not a regular file.
  explicit MappedFile(const std::string& path);
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;
  ~MappedFile();

  const void* data() const noexcept { return data_; }
  std::size_t size() const noexcept { return size_; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace polyfly
