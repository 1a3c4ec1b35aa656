#include "tree/tree_group.hpp"

#include <utility>

namespace polyfly {

void TreeGroup::begin(const TreeRegions& regions, const TreeOptions& options) {
  if (isAlone() || !leads()) return;
  std::vector<std::byte> task;
  ByteWriter out(task);
  out.put(static_cast<std::int32_t>(regions.p));
  writeList(regions.planes, out);
  writeList(regions.centres, out);
  out.put(static_cast<std::uint64_t>(regions.rows.size()));
  for (const std::vector<std::int32_t>& rows : regions.rows) writeList(rows, out);
  out.put(options.mode);
  out.put(options.node_limit);
  out.put(options.explored_pivots);
  out.put(options.memory_limit);
  out.put(options.planes_tried);
  out.put(options.all_rows);
  out.put(options.side_tolerance);
  out.put(options.least_cell);
  out.put(options.least_angle);
  exchange_.begin(task);
}

TreeTask readTask(const std::vector<std::byte>& bytes) {
  TreeTask task;
  ByteReader in(bytes.data(), bytes.size(), "message of process 0");
  task.regions.p = in.get<std::int32_t>();
  readList(in, task.regions.planes);
  readList(in, task.regions.centres);
  const auto count = in.get<std::uint64_t>();
  in.need(count, sizeof(std::uint64_t));
  task.regions.rows.resize(count);
  for (std::vector<std::int32_t>& rows : task.regions.rows) readList(in, rows);
  task.options.mode = in.get<TreeMode>();
  task.options.node_limit = in.get<std::uint64_t>();
  task.options.explored_pivots = in.get<std::uint64_t>();
  task.options.memory_limit = in.get<std::uint64_t>();
  task.options.planes_tried = in.get<std::uint64_t>();
  task.options.all_rows = in.get<bool>();
  task.options.side_tolerance = in.get<double>();
  task.options.least_cell = in.get<double>();
  task.options.least_angle = in.get<double>();
  return task;
}

void TreeGroup::share(const std::vector<ShareRange>& shares, std::vector<SplitOutcome>& outcomes,
                      bool& stop) {
  if (isAlone()) return;
  std::vector<std::byte> mine;
  ByteWriter out(mine);
  out.put(stop);
  for (std::size_t i = 0; i < shares.size(); ++i) {
    if (speaksFor(shares[i])) out.put(outcomes[i]);
  }
  const std::vector<std::vector<std::byte>> all = exchange_.round(std::move(mine));
  std::vector<ByteReader> in;
  for (const std::vector<std::byte>& one : all)
    in.emplace_back(one.data(), one.size(), "message of the group");
  stop = in.front().get<bool>();
  for (std::size_t rank = 1; rank < in.size(); ++rank) in[rank].get<bool>();
  for (std::size_t i = 0; i < shares.size(); ++i)
    outcomes[i] = in[static_cast<std::size_t>(speaker(shares[i]))].get<SplitOutcome>();
}

}  // namespace polyfly
