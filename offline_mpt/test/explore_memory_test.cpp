// The memory that an exploration says it holds is what it takes from the heap, and it is little.
#include <gtest/gtest.h>
#include <malloc.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <vector>

#include "offline_mpt/explore.hpp"
#include "random_program.hpp"
#include "support/arena.hpp"

namespace {

std::atomic<std::int64_t> in_use{0};  // bytes from operator new

void* counted(std::size_t bytes) {
  void* const memory = std::malloc(bytes > 0 ? bytes : 1);
  if (memory == nullptr) throw std::bad_alloc();
  in_use += static_cast<std::int64_t>(malloc_usable_size(memory));
  return memory;
}

void* counted(std::size_t bytes, std::size_t alignment) {
  void* const memory = std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (memory == nullptr) throw std::bad_alloc();
  in_use += static_cast<std::int64_t>(malloc_usable_size(memory));
  return memory;
}

void release(void* memory) {
  if (memory != nullptr) in_use -= static_cast<std::int64_t>(malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t bytes) { return counted(bytes); }
void* operator new[](std::size_t bytes) { return counted(bytes); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return counted(bytes, static_cast<std::size_t>(alignment));
}
void* operator new[](std::size_t bytes, std::align_val_t alignment) {
  return counted(bytes, static_cast<std::size_t>(alignment));
}
void operator delete(void* memory) noexcept { release(memory); }
void operator delete[](void* memory) noexcept { release(memory); }
void operator delete(void* memory, std::size_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t) noexcept { release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::align_val_t) noexcept { release(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept { release(memory); }

namespace polyfly {
namespace {

constexpr double kPerRegion = 2000.0;                     // [bytes] promised at 4 parameters
constexpr std::int64_t kBesides = std::int64_t{1} << 20;  // workers, batches, the scaled program

TEST(ExploreMemory, IsWhatTheHeapHolds) {
  const ParametricProgram program = randomProgram(12, 40, 4, 2);
  ExploreOptions options;
  options.region_limit = 4000;
  const std::int64_t before = in_use;
  std::int64_t greatest = 0;
  std::uint64_t accounted = 0;
  options.progress = [&](const ExploreProgress& state) {
    greatest = std::max(greatest, in_use - before);
    accounted = std::max(accounted, state.memory);
  };
  const Partition partition = explore(program, options);
  ASSERT_GT(partition.regions.size(), 2000u) << "too small to tell";
  EXPECT_GE(static_cast<std::int64_t>(accounted), greatest - kBesides);
  EXPECT_LE(static_cast<std::int64_t>(accounted), greatest + kBesides / 16);
  EXPECT_LE(accounted, partition.stats.memory_bytes);
  EXPECT_LT(static_cast<double>(partition.stats.memory_bytes),
            kPerRegion * static_cast<double>(partition.regions.size()));
}

// As regions are converted: arrays of any size, each freed once the next one was used.
TEST(Arena, FreesWhatWasAllocatedBeforeAnArray) {
  constexpr std::size_t kArrays = 5000;
  const std::int64_t before = in_use;
  CountedMemory memory;
  {
    Arena<double> arena(memory);
    std::vector<double*> arrays;
    for (std::size_t k = 0; k < kArrays; ++k) {
      const std::size_t size = k % 1000 == 7 ? 300'000 : 1 + k % 300;  // some are larger than a block
      arrays.push_back(arena.allocate(size));
      arrays.back()[0] = static_cast<double>(k);
      arrays.back()[size - 1] = static_cast<double>(k);
    }
    const std::uint64_t whole = memory.bytes();
    std::uint64_t last = whole;
    for (std::size_t k = 0; k < kArrays; ++k) {
      arena.releaseBefore(arrays[k]);
      EXPECT_EQ(arrays[k][0], static_cast<double>(k));
      EXPECT_LE(memory.bytes(), last);
      last = memory.bytes();
      if (k == kArrays / 2) {
        EXPECT_LT(last, whole * 6 / 10);
      }
    }
    EXPECT_LT(last, whole / 10);
    *arena.allocate(1) = 1.0;  // it can grow again
  }
  EXPECT_EQ(memory.bytes(), 0u);
  EXPECT_EQ(in_use, before);
}

}  // namespace
}  // namespace polyfly
