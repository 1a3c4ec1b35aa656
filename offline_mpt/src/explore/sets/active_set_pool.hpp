#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory_resource>
#include <optional>
#include <vector>

#include "support/arena.hpp"

namespace polyfly {

/// Rows of an active set, ascending. A view: into a pool it lives as long as that pool.
struct RowSpan {
  const std::uint16_t* rows = nullptr;
  std::size_t count = 0;

  const std::uint16_t* begin() const { return rows; }
  const std::uint16_t* end() const { return rows + count; }
};

/// A set of active sets that remembers the order in which they came: set k is the k-th that was new.
class ActiveSetPool {
 public:
  explicit ActiveSetPool(CountedMemory& memory);

  /// Whether the set was new. Throws Error when there are 2^32 - 1 sets.
  bool insert(RowSpan set);

  /// The set will be asked for soon: brings the part of the table that tells of it near.
  void prefetch(RowSpan set) const;

  /// Index of the set, none where it is new.
  std::optional<std::uint32_t> find(RowSpan set) const;

  std::uint32_t size() const { return static_cast<std::uint32_t>(sets_.size()); }

  /// The rows keep their address.
  RowSpan operator[](std::uint32_t index) const { return {sets_[index] + 1, *sets_[index]}; }

 private:
  // An entry of the hash table: a set's index + 1, 0 where it is free, and what the hash has besides.
  struct Slot {
    std::uint32_t set = 0;
    std::uint32_t hash = 0;
  };

  std::size_t placeOf(RowSpan set, std::uint32_t hash) const;
  void grow();

  // Size of each set, then its rows.
  Arena<std::uint16_t> arena_;
  std::pmr::deque<const std::uint16_t*> sets_;
  std::pmr::vector<Slot> table_;
};

}  // namespace polyfly
