#include "support/run_on_pool.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <cstddef>

namespace polyfly {

void runOnPool(int threads, void (*work)(void*), void* context) {
  const tbb::global_control at_least(tbb::global_control::max_allowed_parallelism,
                                     static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(
        0, threads, [&](int) { work(context); }, tbb::simple_partitioner());
  });
}

}  // namespace polyfly
