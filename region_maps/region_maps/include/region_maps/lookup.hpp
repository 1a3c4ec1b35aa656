#pragma once

#include <cstddef>
#include <cstdint>

namespace polyfly {

/// What a look-up found.
enum class LookupStatus : std::uint8_t {
  kInside,      ///< theta lies in `region`
  kOutsideBox,  ///< a parameter is out of its range
  /// In the box, but in no region: the problem is infeasible there, or the map has a hole.
  kOutsidePartition,
  kNotFinite,  ///< NaN or infinity in theta
};

struct Lookup {
  LookupStatus status = LookupStatus::kNotFinite;
  std::uint32_t region = 0;  ///< valid with kInside
  std::uint32_t law = 0;     ///< valid with kInside
};

/// Bounds on the cost of one look-up in double, computed from the tree when the map opens. The search index adds
/// work in 16 bits (IndexCost::multiply_adds) and mostly saves this.
struct LookupCost {
  std::uint32_t depth = 0;          ///< greatest number of interior nodes on a path
  std::uint32_t region_checks = 0;  ///< greatest number of half-spaces tested at a leaf
  std::uint64_t multiply_adds = 0;  ///< greatest number of multiply-adds of `evaluate`
};

/// The search index: a copy of tree and half-spaces in 16 bits, made in memory when the map opens. Answers are
/// those of the file, bit for bit. All 0 where a map has none, and look-ups read the file alone.
struct IndexCost {
  std::size_t blocks = 0;  ///< each of three levels of the tree
  std::size_t bytes = 0;
  std::uint64_t multiply_adds = 0;  ///< greatest number of multiply-adds of 16 bits in a look-up
};

}  // namespace polyfly
