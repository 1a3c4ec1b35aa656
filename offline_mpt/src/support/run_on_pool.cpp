#include "support/run_on_pool.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace polyfly {
namespace {

// More than an arena takes.
constexpr std::size_t kArenaBytes = std::size_t{4} << 20;

// Where memory runs out while TBB (2022) makes its arena, TBB waits for itself and never returns.
void requireMemoryForArena() {
  void* volatile memory = std::malloc(kArenaBytes);
  if (memory == nullptr) throw std::bad_alloc();
  std::free(memory);
}

}  // namespace

void runOnPool(int threads, void (*work)(void*), void* context) {
  requireMemoryForArena();
  const tbb::global_control at_least(tbb::global_control::max_allowed_parallelism,
                                     static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(
        0, threads, [&](int) { work(context); }, tbb::simple_partitioner());
  });
}

}  // namespace polyfly
