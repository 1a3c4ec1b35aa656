#pragma once

#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "offline_mpt/search_tree.hpp"

namespace polyfly {

/// Writes leaves to a tree. Equal ones are written once.
class LeafWriter {
 public:
  /// `tree` must outlive the object.
  explicit LeafWriter(SearchTree& tree) : tree_(tree) {}

  /// Index of the leaf in the tree, with `count` candidates and as many tests.
  std::uint32_t write(const std::uint32_t* candidates, const std::uint32_t* tests, std::uint32_t count);

 private:
  SearchTree& tree_;
  // Leaves that are written, by a hash of what they hold.
  std::unordered_multimap<std::size_t, std::uint32_t> written_;
};

/// Half-spaces that the worst look-up evaluates. Without tests in the tree, leaves test all rows of their candidates.
std::uint64_t worstLookUp(const SearchTree& tree, const TreeRegions& regions);

}  // namespace polyfly
