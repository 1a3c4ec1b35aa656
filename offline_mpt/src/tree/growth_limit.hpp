#pragma once

#include <cstdint>
#include <optional>

#include "offline_mpt/search_tree.hpp"

namespace polyfly {

/// What a growing tree has taken.
struct Growth {
  std::uint64_t nodes = 0;
  std::uint64_t pivots = 0;
  std::uint64_t bytes = 0;   // of the tree in a map file
  std::uint64_t memory = 0;  // of the cells [bytes]
  std::uint64_t worst = 0;   // half-spaces of the worst look-up
};

/// When a tree has grown enough.
class GrowthLimit {
 public:
  GrowthLimit(const TreeRegions& regions, const TreeOptions& options);

  /// For a part of the tree with a share of what is left, 0 .. 1, which may take the memory up to the limit.
  GrowthLimit part(const Growth& now, double share, std::uint64_t memory_limit) const;

  std::uint64_t nodes() const { return most_.nodes; }

  /// Which limit a tree has reached.
  std::optional<TreeEnd> reached(const Growth& now);

 private:
  bool gainsLittle(const Growth& now);

  TreeMode mode_;
  Growth most_;
  // kAuto: pivots that are enough once the worst look-up has at most short_ half-spaces.
  std::uint64_t enough_ = 0;
  std::uint64_t short_ = 0;
  std::uint64_t memory_;
  std::uint64_t checked_nodes_ = 0;  // when the gain is looked at next
  std::uint64_t checked_worst_ = 0;
};

}  // namespace polyfly
