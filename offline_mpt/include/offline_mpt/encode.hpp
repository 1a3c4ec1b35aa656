#pragma once

#include "mpc_core/parametric_program.hpp"
#include "offline_mpt/partition.hpp"
#include "offline_mpt/search_tree.hpp"
#include "region_maps/map_content.hpp"

namespace polyfly {

/// Greatest difference between the coefficients of two laws that are written once. Parameters are scaled, and the
/// difference is relative to the greatest output that occurs at a region's centre. Nor may u differ by more than half
/// of what proofs allow.
constexpr double kSameLaw = 1e-9;

/// Shares planes and laws among regions, builds the search tree and fills all that a map file holds.
/// The tree answers as a test of all regions would. Throws Error when the partition has no region.
MapContent encode(const ParametricProgram& program, const Partition& partition,
                  const TreeOptions& options = {});

}  // namespace polyfly
