#include "explore/parallel/result_message.hpp"

namespace polyfly {
namespace {

template <typename T>
void readArray(ByteReader& in, std::size_t count, std::vector<T>& values) {
  in.need(count, sizeof(T));
  values.resize(count);
  in.getArray(values.data(), count);
}

void writeRegion(const Region& region, ByteWriter& out) {
  out.put(static_cast<std::uint8_t>(region.by_slack));
  writeSet({region.tight.data(), region.tight.size()}, out);
  out.put(region.radius);
  out.putArray(region.centre.data(), region.centre.size());
  out.putArray(region.law.data(), region.law.size());
  out.put(static_cast<std::uint32_t>(region.facets.size()));
  for (const Facet& facet : region.facets) out.putArray(facet.row.data(), region.centre.size() + 1);
}

void readRegion(const NormalisedProgram& program, ByteReader& in, Region& region) {
  const auto p = static_cast<std::size_t>(program.p);
  region.by_slack = in.get<std::uint8_t>() != 0;
  readArray(in, in.get<std::uint16_t>(), region.tight);
  region.radius = in.get<double>();
  readArray(in, p, region.centre);
  readArray(in, static_cast<std::size_t>(program.U.rows()) * (p + 1), region.law);
  const auto facets = in.get<std::uint32_t>();
  in.need(facets, (p + 1) * sizeof(double));
  region.facets.resize(facets);
  for (Facet& facet : region.facets) in.getArray(facet.row.data(), p + 1);
}

}  // namespace

void writeSet(RowSpan set, ByteWriter& out) {
  out.put(static_cast<std::uint16_t>(set.count));
  out.putArray(set.rows, set.count);
}

void writeResult(const RegionResult& result, ByteWriter& out) {
  out.put(result.status);
  out.put(result.pivots);
  out.put(static_cast<std::uint32_t>(result.neighbours.size()));
  for (std::size_t k = 0; k < result.neighbours.size(); ++k) writeSet(result.neighbours[k], out);
  if (result.status != BuildStatus::kRegion) return;
  out.put(result.degenerate_facets);
  out.put(static_cast<std::uint32_t>(result.unresolved.size()));
  out.putArray(result.unresolved.data(), result.unresolved.size());
  writeRegion(result.region, out);
}

void readResult(const NormalisedProgram& program, ByteReader& in, RegionResult& result) {
  result.clear();
  result.status = in.get<BuildStatus>();
  result.pivots = in.get<std::uint64_t>();
  const auto neighbours = in.get<std::uint32_t>();
  ActiveSet rows;
  for (std::uint32_t k = 0; k < neighbours; ++k) {
    readArray(in, in.get<std::uint16_t>(), rows);
    result.neighbours.push({rows.data(), rows.size()});
  }
  if (result.status != BuildStatus::kRegion) return;
  result.degenerate_facets = in.get<std::uint32_t>();
  readArray(in, in.get<std::uint32_t>(), result.unresolved);
  readRegion(program, in, result.region);
}

}  // namespace polyfly
