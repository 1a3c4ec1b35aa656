#include "explore/parallel/crew.hpp"

#include <algorithm>
#include <atomic>
#include <thread>

#include "explore/region/describe.hpp"
#include "explore/state/exploration_state.hpp"
#include "support/lend_threads.hpp"

namespace polyfly {
namespace {

class RegionDescriber : public Describer {
 public:
  RegionDescriber(const LeastDistance& program, const ExploreOptions& options)
      : program_(program), worker_(program, options) {}

  void answer(RowSpan set, ByteWriter& out) override {
    active_.assign(set.begin(), set.end());
    describe(program_, worker_, active_, described_);
    writeAnswer(described_, active_, worker_.pivots() - pivots_, out);
    pivots_ = worker_.pivots();
  }

 private:
  const LeastDistance& program_;
  Worker worker_;
  ActiveSet active_;
  Described described_;
  unsigned long long pivots_ = 0;
};

void work(const MakeDescriber& make, Desk& desk) {
  try {
    const std::unique_ptr<Describer> describer = make();
    while (Chunk* const chunk = desk.take()) {
      ByteWriter answers(chunk->answers);
      for (const RowSpan& set : chunk->sets) describer->answer(set, answers);
      desk.give(chunk);
    }
  } catch (...) {
    desk.fail(std::current_exception());
  }
}

/// What the threads of a crew share.
struct Crew {
  const MakeDescriber& make;
  Desk& desk;
};

// TBB orders what is before its tasks, in them and after them. The thread sanitizer does not see that
// (lend_threads.hpp): this says it again.
std::atomic<unsigned> order{0};

void join(void* context) {
  order.fetch_add(1, std::memory_order_acq_rel);
  const Crew& crew = *static_cast<const Crew*>(context);
  work(crew.make, crew.desk);
  order.fetch_add(1, std::memory_order_acq_rel);
}

}  // namespace

int crewSize(const ExploreOptions& options) {
  return std::clamp(options.threads, 1, static_cast<int>(std::max(1u, std::thread::hardware_concurrency())));
}

MakeDescriber regionDescribers(const LeastDistance& program, const ExploreOptions& options) {
  return [&] { return std::make_unique<RegionDescriber>(program, options); };
}

// The desk is what the threads meet at: its mutex orders all that they share. TBB may lend fewer threads,
// which changes nothing but the time.
void runCrew(const MakeDescriber& make, int threads, Desk& desk) {
  if (threads == 1) return work(make, desk);
  Crew crew{make, desk};
  order.fetch_add(1, std::memory_order_acq_rel);
  lendThreads(threads, join, &crew);
  order.fetch_add(1, std::memory_order_acq_rel);
}

}  // namespace polyfly
