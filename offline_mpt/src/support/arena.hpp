#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory_resource>
#include <utility>
#include <vector>

namespace polyfly {

/// Memory from the heap, counted as the heap rounds it. One object, one thread at a time.
class CountedMemory : public std::pmr::memory_resource {
 public:
  std::uint64_t bytes() const { return bytes_; }
  std::uint64_t peak() const { return peak_; }

 private:
  // Bytes that the heap adds to a block, and the step of its block sizes.
  static constexpr std::size_t kHeader = 8;
  static constexpr std::size_t kStep = 16;

  static std::uint64_t rounded(std::size_t bytes) { return (bytes + kHeader + kStep - 1) / kStep * kStep; }

  void* do_allocate(std::size_t bytes, std::size_t alignment) override {
    void* const memory = std::pmr::new_delete_resource()->allocate(bytes, alignment);
    bytes_ += rounded(bytes);
    peak_ = std::max(peak_, bytes_);
    return memory;
  }
  void do_deallocate(void* memory, std::size_t bytes, std::size_t alignment) override {
    std::pmr::new_delete_resource()->deallocate(memory, bytes, alignment);
    bytes_ -= rounded(bytes);
  }
  bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override { return this == &other; }

  std::uint64_t bytes_ = 0;
  std::uint64_t peak_ = 0;
};

/// Arrays of plain numbers that keep their addresses and are freed together. Grows by blocks, so that no
/// growth copies, and that little is empty.
template <typename T>
class Arena {
 public:
  explicit Arena(CountedMemory& memory) : memory_(memory), blocks_(&memory) {}
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  ~Arena() {
    while (freed_ < blocks_.size()) freeOldest();
  }

  /// `count` numbers, not initialised.
  T* allocate(std::size_t count) {
    if (count > left_) addBlock(count);
    T* const result = next_;
    next_ += count;
    left_ -= count;
    return result;
  }

  /// What was allocated before `array`, itself from allocate(), is not used any more: frees whole blocks of
  /// it.
  void releaseBefore(const T* array) {
    while (!holds(blocks_[freed_], array)) freeOldest();
  }

 private:
  using Block = std::pair<T*, std::size_t>;

  static constexpr std::size_t kFirst = (std::size_t{1} << 12) / sizeof(T);
  static constexpr std::size_t kMost = (std::size_t{1} << 20) / sizeof(T);

  void addBlock(std::size_t count) {
    const std::size_t size =
        std::max(count, std::min(kMost, kFirst << std::min<std::size_t>(blocks_.size(), 16)));
    blocks_.reserve(blocks_.size() + 1);
    next_ = static_cast<T*>(memory_.allocate(size * sizeof(T), alignof(T)));
    left_ = size;
    blocks_.emplace_back(next_, size);
  }

  static bool holds(const Block& block, const T* array) {
    return !std::less<>()(array, block.first) && std::less<>()(array, block.first + block.second);
  }

  void freeOldest() {
    const auto& [block, size] = blocks_[freed_++];
    memory_.deallocate(block, size * sizeof(T), alignof(T));
  }

  CountedMemory& memory_;
  // Blocks in the order of allocation.
  std::pmr::vector<Block> blocks_;
  // Number of blocks freed, the first ones of blocks_.
  std::size_t freed_ = 0;
  T* next_ = nullptr;
  std::size_t left_ = 0;
};

}  // namespace polyfly
