#include "explore/state/exploration_state.hpp"

namespace polyfly {

void writeSet(RowSpan set, ByteWriter& out) {
  out.put(static_cast<std::uint16_t>(set.count));
  out.putArray(set.rows, set.count);
}

RowSpan readSet(ByteReader& in, std::vector<std::uint16_t>& rows) {
  rows.resize(in.get<std::uint16_t>());
  in.getArray(rows.data(), rows.size());
  return {rows.data(), rows.size()};
}

ExplorationState::ExplorationState(const NormalisedProgram& program)
    : tight(memory), regions(program.p, static_cast<int>(program.U.rows()), memory), unresolved(&memory) {}

void writeNumbers(const Region& region, ByteWriter& out) {
  out.put(region.radius);
  out.putArray(region.centre.data(), region.centre.size());
  out.putArray(region.law.data(), region.law.size());
  for (const Facet& facet : region.facets) out.putArray(facet.row.data(), region.centre.size() + 1);
}

void writeAnswer(const RegionResult& described, const ActiveSet& active, std::uint64_t pivots,
                 ByteWriter& out) {
  out.put(described.status);
  out.put(pivots);
  out.put(static_cast<std::uint32_t>(described.neighbours.size()));
  for (std::size_t k = 0; k < described.neighbours.size(); ++k) writeSet(described.neighbours[k], out);
  if (described.status != BuildStatus::kRegion) return;
  const Region& region = described.region;
  // Bounded by slacks alone, a region is known by its tight rows; an empty set here: by its active set.
  const bool by_tight = region.by_slack && region.tight.size() > active.size();
  writeSet({region.tight.data(), by_tight ? region.tight.size() : 0}, out);
  out.put(described.degenerate_facets);
  out.put(static_cast<std::uint32_t>(described.unresolved.size()));
  out.putArray(described.unresolved.data(), described.unresolved.size());
  out.put(static_cast<std::uint32_t>(region.facets.size()));
  writeNumbers(region, out);
}

void ExplorationState::merge(ByteReader& answer) {
  const auto status = answer.get<BuildStatus>();
  pivots += answer.get<std::uint64_t>();
  const auto neighbours = answer.get<std::uint32_t>();
  neighbours_.clear();
  for (std::uint32_t k = 0; k < neighbours; ++k) {
    neighbours_.push(readSet(answer, rows_));
    found.prefetch(neighbours_[k]);
  }
  for (std::uint32_t k = 0; k < neighbours; ++k) found.insert(neighbours_[k]);
  if (status == BuildStatus::kFailed) failed = true;
  if (status == BuildStatus::kRegion) mergeRegion(answer);
  ++described;
}

void ExplorationState::mergeRegion(ByteReader& answer) {
  const RowSpan tight_rows = readSet(answer, rows_);
  degenerate_facets += answer.get<std::uint32_t>();
  // Known tight rows mean that the same region was found before.
  const bool known = tight_rows.count > 0 && !tight.insert(tight_rows);
  const auto count = answer.get<std::uint32_t>();
  answer.need(count, sizeof(double));
  std::vector<double> probes(count);
  answer.getArray(probes.data(), count);
  const auto facets = answer.get<std::uint32_t>();
  const std::size_t numbers = regions.numberCount(facets);
  if (known) {
    answer.skip(numbers * sizeof(double));
    return;
  }
  unresolved.insert(unresolved.end(), probes.begin(), probes.end());
  answer.need(numbers, sizeof(double));
  answer.getArray(regions.add(static_cast<std::uint32_t>(described), facets), numbers);
}

}  // namespace polyfly
