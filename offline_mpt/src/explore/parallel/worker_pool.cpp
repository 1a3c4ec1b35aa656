#include "explore/parallel/worker_pool.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "explore/region/compute_region.hpp"
#include "explore/state/exploration_state.hpp"
#include "support/run_on_pool.hpp"

namespace polyfly {
namespace {

class RegionWorker : public Worker {
 public:
  RegionWorker(const NormalisedProgram& program, const ExploreOptions& options)
      : program_(program), worker_(program, options) {}

  void answer(RowSpan set, ByteWriter& out) override {
    active_.assign(set.begin(), set.end());
    computeRegion(program_, worker_, active_, described_);
    writeAnswer(described_, active_, worker_.pivots() - pivots_, out);
    pivots_ = worker_.pivots();
  }

 private:
  const NormalisedProgram& program_;
  RegionWorkspace worker_;
  ActiveSet active_;
  RegionResult described_;
  unsigned long long pivots_ = 0;
};

void work(const MakeWorker& make, WorkQueue& queue) {
  try {
    const std::unique_ptr<Worker> worker = make();
    while (Batch* const batch = queue.pop()) {
      ByteWriter answers(batch->answers);
      for (const RowSpan& set : batch->sets) worker->answer(set, answers);
      queue.complete(batch);
    }
  } catch (...) {
    queue.abort(std::current_exception());
  }
}

/// What the threads of a pool share.
struct WorkerPool {
  const MakeWorker& make;
  WorkQueue& queue;
};

// TBB orders what is before its tasks, in them and after them. The thread sanitizer does not see that
// (run_on_pool.hpp): this says it again.
std::atomic<unsigned> order{0};

void join(void* context) {
  order.fetch_add(1, std::memory_order_acq_rel);
  const WorkerPool& pool = *static_cast<const WorkerPool*>(context);
  work(pool.make, pool.queue);
  order.fetch_add(1, std::memory_order_acq_rel);
}

}  // namespace

int workerCount(const ExploreOptions& options) {
  return std::clamp(options.threads, 1, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

MakeWorker regionWorkers(const NormalisedProgram& program, const ExploreOptions& options) {
  return [&] { return std::make_unique<RegionWorker>(program, options); };
}

// The mutex of the queue protects all that the threads share. TBB may provide fewer threads,
// which changes nothing but the time.
void runWorkers(const MakeWorker& make, int threads, WorkQueue& queue) {
  if (threads == 1) return work(make, queue);
  WorkerPool pool{make, queue};
  order.fetch_add(1, std::memory_order_acq_rel);
  runOnPool(threads, join, &pool);
  order.fetch_add(1, std::memory_order_acq_rel);
}

}  // namespace polyfly
