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

/// Bounds on the cost of one look-up in double, computed from the tree when the map opens.
struct LookupCost {
  std::uint32_t depth = 0;          ///< greatest number of interior nodes on a path
  std::uint32_t region_checks = 0;  ///< greatest number of half-spaces tested at a leaf
  std::uint64_t multiply_adds = 0;  ///< greatest number of multiply-adds of `evaluate`
};

}  // namespace polyfly
