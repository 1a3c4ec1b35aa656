#include "explore/parallel/scheduler.hpp"

#include <algorithm>

#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Sets in a batch for a thread of this process, at most.
constexpr std::size_t kMostSets = 16;
// Number of batches into which the open sets are divided, for each worker.
constexpr std::size_t kShare = 4;
// Batches in work at a time, for each worker.
constexpr std::size_t kWindow = 16;
// Greatest share of the time that saving may take.
constexpr double kSavingShare = 0.05;

}  // namespace

Scheduler::Scheduler(SetQueue& state, const ExploreOptions& options, std::function<void()> save)
    : state_(state),
      options_(options),
      save_(std::move(save)),
      next_save_(begin_ + std::chrono::duration_cast<Clock::duration>(
                              std::chrono::duration<double>(options.checkpoint_period))),
      workers_(static_cast<std::size_t>(std::max(1, options.threads))),
      dispatched_(state.described) {}

Batch* Scheduler::next(std::size_t most) {
  const std::uint64_t open = undispatched();
  if (open == 0 || out_.size() >= kWindow * workers_) return nullptr;
  const std::uint64_t count = std::clamp<std::uint64_t>(open / (kShare * workers_), 1, most);
  if (spare_.empty()) spare_.push_back(std::make_unique<Batch>());
  out_.push_back(std::move(spare_.back()));
  spare_.pop_back();
  Batch& batch = *out_.back();
  batch.number = batches_++;
  batch.sets.clear();
  batch.answers.clear();
  batch.answered = false;
  for (std::uint64_t k = 0; k < count; ++k) {
    batch.sets.push_back(state_.found[static_cast<std::uint32_t>(dispatched_++)]);
  }
  return &batch;
}

Batch* Scheduler::pop() {
  Lock lock(mutex_);
  while (!ended_) {
    if (limitReached()) break;
    saveIfDue();
    if (Batch* const batch = next(kMostSets)) return batch;
    if (out_.empty()) {
      stop(ExploreStatus::kComplete);
      break;
    }
    ++waiting_;
    changed_.wait(lock);
    --waiting_;
  }
  return nullptr;
}

Batch* Scheduler::tryPop(std::size_t most) {
  const Lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock() || ended_ || limitReached()) return nullptr;
  saveIfDue();
  return next(most);
}

void Scheduler::complete(Batch* batch) {
  Lock lock(mutex_);
  merge(batch);
  report(lock);
}

bool Scheduler::tryComplete(Batch* batch) {
  const Lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return false;
  merge(batch);
  return true;
}

void Scheduler::poll() {
  const Lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock() && !ended_ && !limitReached()) saveIfDue();
}

void Scheduler::merge(Batch* batch) {
  batch->answered = true;
  while (!ended_ && !out_.empty() && out_.front()->answered) {
    Batch& front = *out_.front();
    ByteReader answers(front.answers.data(), front.answers.size(), "answer to a chunk of active sets");
    for (std::size_t k = 0; k < front.sets.size(); ++k) {
      if (limitReached()) return;
      state_.merge(answers);
    }
    spare_.push_back(std::move(out_.front()));
    out_.pop_front();
  }
  if (waiting_ > 0) changed_.notify_all();
}

// Sends the numbers from the thread that asked for the exploration, and not while others wait for it.
void Scheduler::report(Lock& lock) {
  if (!options_.progress || std::this_thread::get_id() != owner_) return;
  const ExploreProgress progress{state_.regionCount(), state_.open(), state_.described, state_.memory.bytes(),
                                 unsaved_};
  lock.unlock();
  options_.progress(progress);
}

bool Scheduler::limitReached() {
  if (state_.open() == 0) return false;  // nothing is left to do
  if (options_.stop != nullptr && options_.stop->load()) {
    stop(ExploreStatus::kInterrupted);
  } else if (state_.regionCount() >= options_.region_limit || state_.enough() ||
             (options_.memory_limit > 0 && state_.memory.bytes() >= options_.memory_limit) ||
             (options_.time_limit > 0.0 &&
              std::chrono::duration<double>(Clock::now() - begin_).count() > options_.time_limit)) {
    stop(ExploreStatus::kLimited);
  }
  return ended_;
}

void Scheduler::saveIfDue() {
  if (!save_ || options_.checkpoint_period <= 0.0) return;
  const Clock::time_point before = Clock::now();
  if (before < next_save_) return;
  try {
    save_();
    unsaved_ = false;
  } catch (const Error&) {  // a full disk must not cost the work: the next attempt, or the last, may succeed
    unsaved_ = true;
  }
  const std::chrono::duration<double> taken = Clock::now() - before;
  const double pause = std::max(options_.checkpoint_period, taken.count() / kSavingShare);
  next_save_ =
      Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(pause));
}

void Scheduler::stop(ExploreStatus status) {
  ended_ = true;
  status_ = status;
  changed_.notify_all();
}

void Scheduler::end(ExploreStatus status) {
  const Lock lock(mutex_);
  if (!ended_) stop(status);
}

void Scheduler::abort(std::exception_ptr error) {
  const Lock lock(mutex_);
  if (!error_) error_ = std::move(error);
  if (!ended_) stop(ExploreStatus::kInterrupted);
}

void Scheduler::addWorkers(int count) {
  const Lock lock(mutex_);
  workers_ += static_cast<std::size_t>(std::max(0, count));
}

bool Scheduler::ended() const {
  const Lock lock(mutex_);
  return ended_;
}

ExploreStatus Scheduler::result() const {
  const Lock lock(mutex_);
  if (error_) std::rethrow_exception(error_);
  return status_;
}

}  // namespace polyfly
