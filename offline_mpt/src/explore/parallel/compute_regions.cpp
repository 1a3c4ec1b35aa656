#include "explore/parallel/compute_regions.hpp"

namespace polyfly {

void computeRegions(const NormalisedProgram& program, const ExploreOptions& options,
                    WorkQueue<RegionResult>& queue) {
  RegionWorkspace workspace(program, options);
  ActiveSet active;
  while (Batch<RegionResult>* const batch = queue.pop()) {
    for (std::size_t k = 0; k < batch->sets.size(); ++k) {
      active.assign(batch->sets[k].begin(), batch->sets[k].end());
      computeRegion(program, workspace, active, batch->results[k]);
    }
    queue.push(batch);
  }
}

}  // namespace polyfly
