#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "explore/parallel/work_queue.hpp"
#include "explore/state/set_queue.hpp"
#include "offline_mpt/explore_options.hpp"
#include "offline_mpt/partition.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {

/// Distributes the open active sets of an exploration. Results are merged in queue order, whatever the order of
/// their arrival. The work ends when no set is open, or when a limit is reached.
template <typename Result>
class Scheduler : public WorkQueue<Result> {
 public:
  /// `save` is called periodically, while the state does not change.
  Scheduler(SetQueue<Result>& state, const ExploreOptions& options, std::function<void()> save);

  Batch<Result>* pop() override;
  void push(Batch<Result>* batch) override;
  void abort(std::exception_ptr error) override;

  /// Without waiting: null or false while another thread holds the state.
  Batch<Result>* tryPop(std::size_t most);
  bool tryPush(Batch<Result>* batch);
  /// Checks the limits, and saves where that is due.
  void poll();

  /// So many more workers will call pop().
  void addWorkers(int count);

  /// Stops the work before its end.
  void end(ExploreStatus status);

  bool ended() const;

  /// How the work ended. Throws what abort() was given.
  ExploreStatus result() const;

 private:
  // Sets in a batch for a thread of this process, at most.
  static constexpr std::size_t kMostSets = 16;
  // Number of batches into which the open sets are divided, for each worker.
  static constexpr std::size_t kShare = 4;
  // Batches in work at a time, for each worker.
  static constexpr std::size_t kWindow = 16;
  // Greatest share of the time that saving may take.
  static constexpr double kSavingShare = 0.05;

  using Clock = std::chrono::steady_clock;
  using Lock = std::unique_lock<std::mutex>;

  Batch<Result>* next(std::size_t most);
  void merge(Batch<Result>* batch);
  bool limitReached();
  void saveIfDue();
  void stop(ExploreStatus status);
  void report(Lock& lock);
  std::uint64_t undispatched() const { return state_.found.size() - dispatched_; }

  SetQueue<Result>& state_;
  const ExploreOptions& options_;
  const std::function<void()> save_;
  const std::thread::id owner_ = std::this_thread::get_id();
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point next_save_;

  // Guards all members that follow, and the state.
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  int waiting_ = 0;
  std::size_t workers_;
  std::uint64_t dispatched_;
  std::uint64_t batches_ = 0;
  // Batches that are not merged yet, in queue order.
  std::deque<std::unique_ptr<Batch<Result>>> out_;
  // Batches to be used again.
  std::vector<std::unique_ptr<Batch<Result>>> spare_;
  bool unsaved_ = false;
  bool ended_ = false;
  ExploreStatus status_ = ExploreStatus::kComplete;
  std::exception_ptr error_;
};

template <typename Result>
Scheduler<Result>::Scheduler(SetQueue<Result>& state, const ExploreOptions& options,
                             std::function<void()> save)
    : state_(state),
      options_(options),
      save_(std::move(save)),
      next_save_(begin_ + std::chrono::duration_cast<Clock::duration>(
                              std::chrono::duration<double>(options.checkpoint_period))),
      workers_(static_cast<std::size_t>(std::max(1, options.threads))),
      dispatched_(state.described) {}

template <typename Result>
Batch<Result>* Scheduler<Result>::next(std::size_t most) {
  const std::uint64_t open = undispatched();
  if (open == 0 || out_.size() >= kWindow * workers_) return nullptr;
  const std::uint64_t count = std::clamp<std::uint64_t>(open / (kShare * workers_), 1, most);
  if (spare_.empty()) spare_.push_back(std::make_unique<Batch<Result>>());
  out_.push_back(std::move(spare_.back()));
  spare_.pop_back();
  Batch<Result>& batch = *out_.back();
  batch.number = batches_++;
  batch.sets.clear();
  batch.is_complete = false;
  for (std::uint64_t k = 0; k < count; ++k) {
    batch.sets.push_back(state_.found[static_cast<std::uint32_t>(dispatched_++)]);
  }
  batch.fitResults();
  return &batch;
}

template <typename Result>
Batch<Result>* Scheduler<Result>::pop() {
  Lock lock(mutex_);
  while (!ended_) {
    if (limitReached()) break;
    saveIfDue();
    if (Batch<Result>* const batch = next(kMostSets)) return batch;
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

template <typename Result>
Batch<Result>* Scheduler<Result>::tryPop(std::size_t most) {
  const Lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock() || ended_ || limitReached()) return nullptr;
  saveIfDue();
  return next(most);
}

template <typename Result>
void Scheduler<Result>::push(Batch<Result>* batch) {
  Lock lock(mutex_);
  merge(batch);
  report(lock);
}

template <typename Result>
bool Scheduler<Result>::tryPush(Batch<Result>* batch) {
  const Lock lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return false;
  merge(batch);
  return true;
}

template <typename Result>
void Scheduler<Result>::poll() {
  const Lock lock(mutex_, std::try_to_lock);
  if (lock.owns_lock() && !ended_ && !limitReached()) saveIfDue();
}

template <typename Result>
void Scheduler<Result>::merge(Batch<Result>* batch) {
  batch->is_complete = true;
  while (!ended_ && !out_.empty() && out_.front()->is_complete) {
    Batch<Result>& front = *out_.front();
    for (std::size_t k = 0; k < front.sets.size(); ++k) {
      if (limitReached()) return;
      state_.merge(front.results[k]);
    }
    spare_.push_back(std::move(out_.front()));
    out_.pop_front();
  }
  if (waiting_ > 0) changed_.notify_all();
}

// Sends the numbers from the thread that asked for the exploration, and not while others wait for it.
template <typename Result>
void Scheduler<Result>::report(Lock& lock) {
  if (!options_.progress || std::this_thread::get_id() != owner_) return;
  const ExploreProgress progress{state_.regionCount(), state_.open(), state_.described, state_.memory.bytes(),
                                 unsaved_};
  lock.unlock();
  options_.progress(progress);
}

template <typename Result>
bool Scheduler<Result>::limitReached() {
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

template <typename Result>
void Scheduler<Result>::saveIfDue() {
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

template <typename Result>
void Scheduler<Result>::stop(ExploreStatus status) {
  ended_ = true;
  status_ = status;
  changed_.notify_all();
}

template <typename Result>
void Scheduler<Result>::end(ExploreStatus status) {
  const Lock lock(mutex_);
  if (!ended_) stop(status);
}

template <typename Result>
void Scheduler<Result>::abort(std::exception_ptr error) {
  const Lock lock(mutex_);
  if (!error_) error_ = std::move(error);
  if (!ended_) stop(ExploreStatus::kInterrupted);
}

template <typename Result>
void Scheduler<Result>::addWorkers(int count) {
  const Lock lock(mutex_);
  workers_ += static_cast<std::size_t>(std::max(0, count));
}

template <typename Result>
bool Scheduler<Result>::ended() const {
  const Lock lock(mutex_);
  return ended_;
}

template <typename Result>
ExploreStatus Scheduler<Result>::result() const {
  const Lock lock(mutex_);
  if (error_) std::rethrow_exception(error_);
  return status_;
}

}  // namespace polyfly
