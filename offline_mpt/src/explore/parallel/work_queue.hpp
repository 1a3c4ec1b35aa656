#pragma once

#include <cstdint>
#include <exception>
#include <vector>

#include "explore/sets/active_set_pool.hpp"

namespace polyfly {

/// Consecutive active sets of the queue, and their results.
template <typename Result>
struct Batch {
  /// Counts the batches of a run, in queue order.
  std::uint64_t number = 0;
  std::vector<RowSpan> sets;
  /// At least one for each set. Results are used again, so that their containers allocate nothing.
  std::vector<Result> results;
  bool is_complete = false;

  /// Makes room for the results of all sets.
  void fitResults() {
    if (results.size() < sets.size()) results.resize(sets.size());
  }
};

/// Active sets to examine. Thread-safe.
template <typename Result>
class WorkQueue {
 public:
  virtual ~WorkQueue() = default;
  /// Waits for a batch. Null: there will be none.
  virtual Batch<Result>* pop() = 0;
  /// Takes a batch back, with its results.
  virtual void push(Batch<Result>* batch) = 0;
  /// Ends the work: pop() returns null from now on.
  virtual void abort(std::exception_ptr error) = 0;
};

}  // namespace polyfly
