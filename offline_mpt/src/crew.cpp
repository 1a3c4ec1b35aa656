#include "crew.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "describe.hpp"
#include "lend_threads.hpp"

namespace polyfly {
namespace {

void work(const LeastDistance& program, const ExploreOptions& options, Desk& desk) {
  try {
    Worker worker(program, options);
    ActiveSet active;
    unsigned long long pivots = 0;
    while (Chunk* const chunk = desk.take()) {
      ByteWriter answers(chunk->answers);
      for (const RowSpan& set : chunk->sets) {
        active.assign(set.begin(), set.end());
        const Described described = describe(program, worker, active);
        writeAnswer(described, active, worker.pivots() - pivots, answers);
        pivots = worker.pivots();
      }
      desk.give(chunk);
    }
  } catch (...) {
    desk.fail(std::current_exception());
  }
}

/// What the threads of a crew share.
struct Crew {
  const LeastDistance& program;
  const ExploreOptions& options;
  Desk& desk;
};

// TBB orders what is before its tasks, in them and after them. The thread sanitizer does not see that
// (lend_threads.hpp): this says it again.
std::atomic<unsigned> order{0};

void join(void* context) {
  order.fetch_add(1, std::memory_order_acq_rel);
  const Crew& crew = *static_cast<const Crew*>(context);
  work(crew.program, crew.options, crew.desk);
  order.fetch_add(1, std::memory_order_acq_rel);
}

}  // namespace

int crewSize(const ExploreOptions& options) {
  return std::clamp(options.threads, 1, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

// The desk is what the threads meet at: its mutex orders all that they share. TBB may lend fewer threads,
// which changes nothing but the time.
void runCrew(const LeastDistance& program, const ExploreOptions& options, int threads, Desk& desk) {
  if (threads == 1) return work(program, options, desk);
  Crew crew{program, options, desk};
  order.fetch_add(1, std::memory_order_acq_rel);
  lendThreads(threads, join, &crew);
  order.fetch_add(1, std::memory_order_acq_rel);
}

}  // namespace polyfly
