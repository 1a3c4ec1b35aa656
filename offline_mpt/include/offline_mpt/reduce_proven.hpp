#pragma once

#include <string>

#include "offline_mpt/reduce.hpp"
#include "offline_mpt/verify_reduction.hpp"
#include "region_maps/map_image.hpp"

namespace polyfly {

/// A reduced map and the proof that it answers as its original.
struct ProvenReduction {
  ReduceStats stats;
  MapImage image;
  /// Failed where no attempt could be proven. The image is then that of the last attempt.
  ReductionReport report;
};

/// Reduces a map and proves the result. Where the proof fails, the search tree left out slivers that matter, or
/// rounding made too much of them. They are added to the leaves, and trees that leave out thicker or thinner ones are
/// tried. `name` is that of the reduced map in errors. Throws Error as reduce and verifyReduction do.
ProvenReduction reduceProven(const RegionMap& map, const std::string& name,
                             const ReduceOptions& reduce_options, const ReductionOptions& proof_options);

}  // namespace polyfly
