#pragma once

#include <exception>
#include <functional>

#include "explore/parallel/work_queue.hpp"
#include "offline_mpt/explore_options.hpp"

namespace polyfly {

/// Number of worker threads: as asked for, at most the processors of the machine.
int workerCount(const ExploreOptions& options);

/// Calls `work`, which does not throw, once on each of `threads` threads, the calling one included.
void runOnThreads(int threads, const std::function<void()>& work);

/// The executor of one process: runs `loop`, which pops from the queue until it ends, on `threads` threads.
template <typename Result>
void runWorkers(int threads, WorkQueue<Result>& queue, const std::function<void(WorkQueue<Result>&)>& loop) {
  runOnThreads(threads, [&] {
    try {
      loop(queue);
    } catch (...) {
      queue.abort(std::current_exception());
    }
  });
}

}  // namespace polyfly
