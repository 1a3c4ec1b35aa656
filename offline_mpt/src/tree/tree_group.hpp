#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "explore/parallel/group_exchange.hpp"
#include "offline_mpt/search_tree.hpp"
#include "support/byte_stream.hpp"

namespace polyfly {

/// Shares first .. last - 1 of a tree, which is divided into kShares. Each process has equally many shares, in order.
struct ShareRange {
  static constexpr std::uint32_t kShares = 1u << 15;
  std::uint32_t first = 0;
  std::uint32_t last = kShares;

  ShareRange lowerHalf() const { return {first, last - first > 1 ? (first + last) / 2 : last}; }
  ShareRange upperHalf() const { return {last - first > 1 ? (first + last) / 2 : first, last}; }
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

/// The processes that build one tree. A cell is held by the processes that have some of its shares, and a split halves
/// its shares. All know the facts of all cells, and so choose the same cells to split. Where several hold a cell, all of
/// them split it, alike.
class TreeGroup {
 public:
  explicit TreeGroup(ProcessGroup* group) : exchange_(group) {}

  bool isAlone() const { return exchange_.size() == 1; }
  bool leads() const { return exchange_.rank() == 0; }
  /// Whether this process has some of the shares.
  bool holds(ShareRange shares) const {
    return exchange_.rank() >= processOf(shares.first) && exchange_.rank() <= processOf(shares.last - 1);
  }
  /// The first process that has some of the shares. It tells the others what became of the cell.
  int speaker(ShareRange shares) const { return processOf(shares.first); }
  bool speaksFor(ShareRange shares) const { return exchange_.rank() == speaker(shares); }

  /// For process 0: hands regions and options to the others.
  void begin(const TreeRegions& regions, const TreeOptions& options);

  /// Fills in the outcomes of all cells, of which each process knows its own. `stop`: that of process 0.
  void share(const std::vector<ShareRange>& shares, std::vector<SplitOutcome>& outcomes, bool& stop);

  /// The contributions of all processes, by rank.
  std::vector<std::vector<std::byte>> round(std::vector<std::byte> mine) {
    return exchange_.round(std::move(mine));
  }

 private:
  int processOf(std::uint32_t share) const {
    return static_cast<int>(std::uint64_t{share} * static_cast<std::uint64_t>(exchange_.size()) /
                            ShareRange::kShares);
  }

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
