#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "explore/parallel/group_exchange.hpp"
#include "offline_mpt/search_tree.hpp"
#include "support/byte_stream.hpp"

namespace polyfly {

/// Processes first .. last - 1 of a group, which all hold a cell. The first one speaks for them.
struct ProcessRange {
  std::uint16_t first = 0;
  std::uint16_t last = 1;

  ProcessRange lowerHalf() const { return {first, last - first > 1 ? middle() : last}; }
  ProcessRange upperHalf() const { return {last - first > 1 ? middle() : first, last}; }

 private:
  std::uint16_t middle() const { return static_cast<std::uint16_t>((first + last) / 2); }
};

/// What all processes know of a cell.
struct CellFacts {
  /// Half-spaces that a look-up evaluates.
  std::uint64_t cost = 0;
  /// What it takes while the tree grows [bytes].
  std::uint64_t memory = 0;
  std::uint32_t members = 0;
  std::uint32_t depth = 0;
};

/// What became of a cell that was to be split.
struct SplitOutcome {
  std::uint64_t pivots = 0;
  std::uint32_t is_split = 0;
  std::uint32_t plane = 0;
  /// Of the cell itself, if it is not split.
  CellFacts cell;
  CellFacts below;
  CellFacts above;
};

/// The processes that build one tree. Each holds some of the cells, and knows the facts of all: so all choose the same
/// cells to split. Whoever splits a cell of several processes does it as the others do.
class TreeGroup {
 public:
  explicit TreeGroup(ProcessGroup* group) : exchange_(group) {}

  ProcessRange all() const { return {0, static_cast<std::uint16_t>(exchange_.size())}; }
  bool isAlone() const { return exchange_.size() == 1; }
  bool leads() const { return exchange_.rank() == 0; }
  bool holds(ProcessRange owners) const {
    return exchange_.rank() >= owners.first && exchange_.rank() < owners.last;
  }
  bool speaksFor(ProcessRange owners) const { return exchange_.rank() == owners.first; }

  /// For process 0: hands regions and options to the others.
  void begin(const TreeRegions& regions, const TreeOptions& options);

  /// Fills in the outcomes of all cells, of which each process knows its own. `stop`: that of process 0.
  void share(const std::vector<ProcessRange>& owners, std::vector<SplitOutcome>& outcomes, bool& stop);

  /// The contributions of all processes, by rank.
  std::vector<std::vector<std::byte>> round(std::vector<std::byte> mine) {
    return exchange_.round(std::move(mine));
  }

 private:
  GroupExchange exchange_;
};

template <typename T>
void writeList(const std::vector<T>& list, ByteWriter& out) {
  out.put(static_cast<std::uint64_t>(list.size()));
  out.putArray(list.data(), list.size());
}

template <typename T>
void readList(ByteReader& in, std::vector<T>& list) {
  const auto count = in.get<std::uint64_t>();
  in.need(count, sizeof(T));
  list.resize(count);
  in.getArray(list.data(), count);
}

/// Regions and options, as a task of process 0 holds them.
struct TreeTask {
  TreeRegions regions;
  TreeOptions options;
};
TreeTask readTask(const std::vector<std::byte>& bytes);

}  // namespace polyfly
