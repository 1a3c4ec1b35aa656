#pragma once

#include <cstdint>

#include "explore/sets/active_set_pool.hpp"
#include "support/arena.hpp"

namespace polyfly {

/// FIFO of active sets. Results are merged in FIFO order, so they do not depend on which thread computed them.
/// `Result` is what one active set yields.
template <typename Result>
struct SetQueue {
  SetQueue() : found(memory) {}
  SetQueue(const SetQueue&) = delete;
  SetQueue& operator=(const SetQueue&) = delete;
  virtual ~SetQueue() = default;

  std::uint64_t open() const { return found.size() - described; }

  /// Regions that count for ExploreOptions::region_limit.
  virtual std::uint64_t regionCount() const = 0;

  /// Whether what was found is enough to stop.
  virtual bool enough() const { return false; }

  /// Merges the result of the set number `described`.
  virtual void merge(const Result& result) = 0;

  /// Memory of `found` and of all containers of derived queues.
  CountedMemory memory;
  ActiveSetPool found;
  /// Number of sets of `found` that were merged.
  std::uint64_t described = 0;
};

}  // namespace polyfly
