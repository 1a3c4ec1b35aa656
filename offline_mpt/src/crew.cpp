#include "crew.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <thread>

#include "describe.hpp"

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
        writeAnswer(described, active, worker.builder.pivots() - pivots, answers);
        pivots = worker.builder.pivots();
      }
      desk.give(chunk);
    }
  } catch (...) {
    desk.fail(std::current_exception());
  }
}

}  // namespace

int crewSize(const ExploreOptions& options) {
  return std::clamp(options.threads, 1, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

// The desk is what the threads meet at: its mutex orders all that they share. TBB only lends the threads,
// and may lend fewer, which changes nothing but the time.
void runCrew(const LeastDistance& program, const ExploreOptions& options, int threads, Desk& desk) {
  if (threads == 1) return work(program, options, desk);
  const tbb::global_control at_least(tbb::global_control::max_allowed_parallelism,
                                     static_cast<std::size_t>(threads));
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(
        0, threads, [&](int) { work(program, options, desk); }, tbb::simple_partitioner());
  });
}

}  // namespace polyfly
