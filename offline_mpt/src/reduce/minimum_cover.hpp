#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace polyfly {

/// A set of the numbers 0 .. size - 1.
class BitSet {
 public:
  explicit BitSet(std::size_t size = 0) : words_((size + 63) / 64, 0) {}
  void set(std::size_t i) { words_[i / 64] |= std::uint64_t{1} << (i % 64); }
  void reset(std::size_t i) { words_[i / 64] &= ~(std::uint64_t{1} << (i % 64)); }
  bool test(std::size_t i) const { return (words_[i / 64] >> (i % 64) & 1) != 0; }
  bool empty() const;
  std::size_t count() const;
  /// Size of the intersection.
  std::size_t countWith(const BitSet& other) const;
  bool subsetOf(const BitSet& other) const;
  void remove(const BitSet& other);
  bool operator==(const BitSet& other) const { return words_ == other.words_; }
  bool operator<(const BitSet& other) const { return words_ < other.words_; }

 private:
  std::vector<std::uint64_t> words_;
};

struct MinimumCover {
  std::vector<std::size_t> chosen;  ///< indices of sets, ascending; they cover every element
  bool proven = false;              ///< no choice is smaller
};

/// Fewest sets whose union is {0 .. size - 1}, by branch and bound: the element that fewest sets hold is
/// covered next, and elements no two of which share a set bound the number from below. Every element must be
/// in some set. After `node_limit` branches the best found so far is returned, unproven.
MinimumCover minimumCover(std::size_t size, const std::vector<BitSet>& sets, std::uint64_t node_limit);

}  // namespace polyfly
