#pragma once

#include <cstdint>

#include "explore/sets/active_set_pool.hpp"
#include "support/arena.hpp"
#include "support/byte_stream.hpp"

namespace polyfly {

/// Active sets in the order in which they were found, which is the order in which they are described: so what
/// has become of k of them is the same whoever described them.
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

  /// Takes in what describing the set `described` yielded.
  virtual void merge(ByteReader& answer) = 0;

  CountedMemory memory;  ///< of all that follows, and of what derived queues hold
  ActiveSetPool found;
  std::uint64_t described = 0;  ///< sets of `found` that were merged
};

/// Reads a set as writeSet wrote it; the view is of `rows`.
RowSpan readSet(ByteReader& in, std::vector<std::uint16_t>& rows);
void writeSet(RowSpan set, ByteWriter& out);

}  // namespace polyfly
