#pragma once

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

#include "explore/state/set_queue.hpp"
#include "offline_mpt/explore_options.hpp"
#include "offline_mpt/partition.hpp"

namespace polyfly {

/// Consecutive active sets of the queue, and their results.
struct Batch {
  /// Counts the batches of a run, in queue order.
  std::uint64_t number = 0;
  std::vector<RowSpan> sets;
  std::vector<std::byte> answers;
  bool answered = false;
};

/// The source of work for workers. Thread-safe.
class WorkQueue {
 public:
  virtual ~WorkQueue() = default;
  /// Waits for a batch. Null: there will be none.
  virtual Batch* pop() = 0;
  /// Returns a processed batch.
  virtual void complete(Batch* batch) = 0;
  /// Ends the work: pop() returns null from now on.
  virtual void abort(std::exception_ptr error) = 0;
};

/// Distributes the open active sets of an exploration. Results are merged in queue order, whatever the order of
/// their arrival. The work ends when no set is open, or when a limit is reached.
class Scheduler : public WorkQueue {
 public:
  /// `save` is called periodically, while the state does not change.
  Scheduler(SetQueue& state, const ExploreOptions& options, std::function<void()> save);

  Batch* pop() override;
  void complete(Batch* batch) override;
  void abort(std::exception_ptr error) override;

  /// Without waiting: null or false while another thread holds the state.
  Batch* tryPop(std::size_t most);
  bool tryComplete(Batch* batch);
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
  using Clock = std::chrono::steady_clock;
  using Lock = std::unique_lock<std::mutex>;

  Batch* next(std::size_t most);
  void merge(Batch* batch);
  bool limitReached();
  void saveIfDue();
  void stop(ExploreStatus status);
  void report(Lock& lock);
  std::uint64_t undispatched() const { return state_.found.size() - dispatched_; }

  SetQueue& state_;
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
  std::deque<std::unique_ptr<Batch>> out_;
  // Batches to be used again.
  std::vector<std::unique_ptr<Batch>> spare_;
  bool unsaved_ = false;
  bool ended_ = false;
  ExploreStatus status_ = ExploreStatus::kComplete;
  std::exception_ptr error_;
};

}  // namespace polyfly
