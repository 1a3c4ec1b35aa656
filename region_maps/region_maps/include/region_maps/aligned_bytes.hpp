#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace polyfly {

/// Heap memory of exactly the given size, aligned as RegionMap::view wants it. Moves, does not copy; one that was moved
/// from may only be assigned to or destroyed.
class AlignedBytes {
 public:
  AlignedBytes() noexcept = default;

  /// Bytes of any value. Throws std::bad_alloc.
  explicit AlignedBytes(std::size_t size);

  /// A copy.
  explicit AlignedBytes(const std::vector<std::byte>& bytes);

  std::byte* data() noexcept { return place_.get(); }
  const std::byte* data() const noexcept { return place_.get(); }
  std::size_t size() const noexcept { return size_; }

 private:
  struct Release {
    void operator()(std::byte* place) const noexcept;
  };

  std::unique_ptr<std::byte, Release> place_;
  std::size_t size_ = 0;
};

}  // namespace polyfly
