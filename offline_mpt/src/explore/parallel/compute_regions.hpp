#pragma once

#include "explore/parallel/work_queue.hpp"
#include "explore/region/compute_region.hpp"
#include "offline_mpt/explore_options.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// The loop of the exploration, as each thread of each process runs it: pops active sets, computes their regions and
/// pushes the results. The queue adds the neighbours that are new.
void computeRegions(const NormalisedProgram& program, const ExploreOptions& options,
                    WorkQueue<RegionResult>& queue);

}  // namespace polyfly
