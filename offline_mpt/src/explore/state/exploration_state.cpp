#include "explore/state/exploration_state.hpp"

#include <algorithm>

namespace polyfly {

ExplorationState::ExplorationState(const NormalisedProgram& program)
    : found(memory),
      tight(memory),
      regions(program.p, static_cast<int>(program.U.rows()), memory),
      unresolved(&memory) {}

void copyNumbers(const Region& region, double* out) {
  *out++ = region.radius;
  out = std::copy(region.centre.begin(), region.centre.end(), out);
  out = std::copy(region.law.begin(), region.law.end(), out);
  for (const Facet& facet : region.facets)
    out = std::copy_n(facet.row.begin(), region.centre.size() + 1, out);
}

void ExplorationState::merge(const RegionResult& result) {
  pivots += result.pivots;
  const ActiveSetList& neighbours = result.neighbours;
  for (std::size_t k = 0; k < neighbours.size(); ++k) found.prefetch(neighbours[k]);
  for (std::size_t k = 0; k < neighbours.size(); ++k) found.insert(neighbours[k]);
  if (result.status == BuildStatus::kFailed) failed = true;
  if (result.status == BuildStatus::kRegion) mergeRegion(result);
  ++described;
}

void ExplorationState::mergeRegion(const RegionResult& result) {
  degenerate_facets += result.degenerate_facets;
  const auto set = static_cast<std::uint32_t>(described);
  const Region& region = result.region;
  // Known tight rows mean that the same region was found before.
  if (region.isKnownByTightRows(found[set].count) &&
      !tight.insert({region.tight.data(), region.tight.size()}))
    return;
  unresolved.insert(unresolved.end(), result.unresolved.begin(), result.unresolved.end());
  copyNumbers(region, regions.add(set, static_cast<std::uint32_t>(region.facets.size())));
}

}  // namespace polyfly
