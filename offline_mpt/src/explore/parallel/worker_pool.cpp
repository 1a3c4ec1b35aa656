#include "explore/parallel/worker_pool.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "support/run_on_pool.hpp"

namespace polyfly {
namespace {

// TBB orders what is before its tasks, in them and after them. The thread sanitizer does not see that
// (run_on_pool.hpp): this says it again.
std::atomic<unsigned> order{0};

void callWork(void* context) {
  order.fetch_add(1, std::memory_order_acq_rel);
  (*static_cast<const std::function<void()>*>(context))();
  order.fetch_add(1, std::memory_order_acq_rel);
}

}  // namespace

int workerCount(const ExploreOptions& options) {
  return std::clamp(options.threads, 1, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

// The mutex of the queue protects all that the threads share. TBB may provide fewer threads,
// which changes nothing but the time.
void runOnThreads(int threads, const std::function<void()>& work) {
  if (threads == 1) return work();
  std::function<void()> shared = work;
  order.fetch_add(1, std::memory_order_acq_rel);
  runOnPool(threads, callWork, &shared);
  order.fetch_add(1, std::memory_order_acq_rel);
}

}  // namespace polyfly
