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

/// Some active sets that follow each other in the queue, and what describing them yielded.
struct Chunk {
  std::uint64_t number = 0;  ///< of the chunks of a run, in the order of the queue
  std::vector<RowSpan> sets;
  std::vector<std::byte> answers;
  bool answered = false;
};

/// Where describers get their work from. Any number of threads.
class Desk {
 public:
  virtual ~Desk() = default;
  /// Waits for work; null when there will be none.
  virtual Chunk* take() = 0;
  /// Takes an answered chunk back.
  virtual void give(Chunk* chunk) = 0;
  /// Ends the work; take() gives null from now on.
  virtual void fail(std::exception_ptr error) = 0;
};

/// Hands out an exploration's open sets, merges the answers in the order of the queue whatever the order they
/// come in, and ends the work when nothing is open or a limit is reached.
class Dispatcher : public Desk {
 public:
  /// `save` is called now and then, with the state at rest.
  Dispatcher(SetQueue& state, const ExploreOptions& options, std::function<void()> save);

  Chunk* take() override;
  void give(Chunk* chunk) override;
  void fail(std::exception_ptr error) override;

  /// For a thread that has to come back soon: these do nothing and say false or null while others keep the
  /// state busy, as saving does.
  Chunk* tryTake(std::size_t most);
  bool tryGive(Chunk* chunk);
  void look();  ///< at the limits and whether saving is due

  /// More threads ask than at first.
  void addDescribers(int count);

  /// Stops the work before its end.
  void end(ExploreStatus status);

  bool ended() const;

  /// How the work ended; what fail() was given is thrown.
  ExploreStatus result() const;

 private:
  using Clock = std::chrono::steady_clock;
  using Lock = std::unique_lock<std::mutex>;

  Chunk* next(std::size_t most);
  void merge(Chunk* chunk);
  bool limitReached();
  void saveIfDue();
  void stop(ExploreStatus status);
  void report(Lock& lock);
  std::uint64_t undispatched() const { return state_.found.size() - handed_out_; }

  SetQueue& state_;
  const ExploreOptions& options_;
  const std::function<void()> save_;
  const std::thread::id owner_ = std::this_thread::get_id();
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point next_save_;

  mutable std::mutex mutex_;  // guards all that follows, and the state
  std::condition_variable changed_;
  int waiting_ = 0;
  std::size_t describers_;
  std::uint64_t handed_out_;
  std::uint64_t chunks_ = 0;
  std::deque<std::unique_ptr<Chunk>> out_;    // not merged yet, in the order of the queue
  std::vector<std::unique_ptr<Chunk>> idle_;  // to be used again
  bool unsaved_ = false;
  bool ended_ = false;
  ExploreStatus status_ = ExploreStatus::kComplete;
  std::exception_ptr error_;
};

}  // namespace polyfly
