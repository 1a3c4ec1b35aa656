#include "tree/growth_limit.hpp"

#include <algorithm>
#include <limits>

namespace polyfly {
namespace {

// Default limits of nodes, per region and at least.
constexpr std::uint64_t kSmallNodes = 64;
constexpr std::uint64_t kOtherNodes = 2;
constexpr std::uint64_t kLeastNodes = 4096;
// Pivots, and at least so many, which take some 20 ms and 0.4 s. The leaves take about half as many again once the tree
// has grown. kFast: per pivot of the exploration. kAuto: per half-space of the regions.
constexpr double kFastPivots = 1.0;
constexpr std::uint64_t kLeastFastPivots = 40000;
constexpr std::uint64_t kAutoPivots = 150;
constexpr std::uint64_t kLeastAutoPivots = 1000000;
// kAuto: this share of the pivots is enough once the worst look-up evaluates at most one half-space of so many.
constexpr double kEnough = 0.4;
constexpr std::uint64_t kShort = 64;
// Not for so few parameters: there planes separate regions well, and further nodes gain much.
constexpr int kFewParameters = 4;
// kAuto: bytes of the tree per byte of the regions, and in any case.
constexpr std::uint64_t kAutoBytes = 3;
constexpr std::uint64_t kFreeBytes = 65536;
// kAuto: the worst case after a doubling of the nodes, relative to the one before, above which more nodes gain little.
constexpr double kLittleGain = 0.85;

// More than any number of pivots, and twice as much is still a number.
constexpr std::uint64_t kNoLimit = std::uint64_t{1} << 62;
// Of TreeOptions::memory_limit, the share that all cells may take before the tree grows in one after the other.
constexpr double kWholeShare = 2.0 / 3.0;

std::uint64_t rowsOf(const TreeRegions& regions) {
  std::uint64_t rows = 0;
  for (const auto& list : regions.rows) rows += list.size();
  return rows;
}

std::uint64_t bytesOf(const TreeRegions& regions) {
  return sizeof(double) * regions.planes.size() + sizeof(std::int32_t) * rowsOf(regions) +
         sizeof(MapContent::Region) * regions.rows.size();
}

std::uint64_t mostPivots(const TreeRegions& regions, const TreeOptions& options) {
  if (options.mode == TreeMode::kFast) {
    const double explored = kFastPivots * static_cast<double>(options.explored_pivots);
    return std::max(kLeastFastPivots, static_cast<std::uint64_t>(explored));
  }
  if (options.mode == TreeMode::kAuto) return std::max(kLeastAutoPivots, kAutoPivots * rowsOf(regions));
  return kNoLimit;
}

}  // namespace

const char* toString(TreeEnd end) {
  switch (end) {
    case TreeEnd::kNoGain:
      return "no split shortens a look-up any more";
    case TreeEnd::kLittleGain:
      return "further nodes gain little";
    case TreeEnd::kNodes:
      return "limit of nodes";
    case TreeEnd::kBytes:
      return "limit of memory";
    case TreeEnd::kMemory:
      return "limit of memory while it grows";
    case TreeEnd::kPivots:
      return "limit of time";
    case TreeEnd::kStopped:
      return "stopped";
  }
  return "unknown";
}

const char* toString(TreeMode mode) {
  switch (mode) {
    case TreeMode::kNone:
      return "none";
    case TreeMode::kFast:
      return "fast";
    case TreeMode::kAuto:
      return "auto";
    case TreeMode::kSmall:
      return "small";
  }
  return "unknown";
}

GrowthLimit::GrowthLimit(const TreeRegions& regions, const TreeOptions& options)
    : mode_(options.mode),
      memory_(static_cast<std::uint64_t>(kWholeShare * static_cast<double>(options.memory_limit))) {
  most_.nodes = options.node_limit;
  const std::uint64_t per_region = mode_ == TreeMode::kSmall ? kSmallNodes : kOtherNodes;
  if (most_.nodes == 0) most_.nodes = std::max(kLeastNodes, per_region * regions.rows.size());
  if (mode_ == TreeMode::kNone) most_.nodes = 0;
  most_.pivots = mostPivots(regions, options);
  enough_ = static_cast<std::uint64_t>(kEnough * static_cast<double>(most_.pivots));
  short_ = regions.p > kFewParameters ? rowsOf(regions) / kShort : 0;
  most_.bytes = kFreeBytes + kAutoBytes * bytesOf(regions);
  checked_nodes_ = std::max<std::uint64_t>(kLeastNodes, regions.rows.size() / 4);
}

GrowthLimit GrowthLimit::part(const Growth& now, double share, std::uint64_t memory_limit) const {
  const auto shared = [share](std::uint64_t most, std::uint64_t used) {
    return used + static_cast<std::uint64_t>(share * static_cast<double>(most - std::min(most, used)));
  };
  GrowthLimit limit = *this;
  limit.most_.nodes = shared(most_.nodes, now.nodes);
  limit.most_.pivots = shared(most_.pivots, now.pivots);
  limit.enough_ = shared(enough_, now.pivots);
  limit.most_.bytes = shared(most_.bytes, now.bytes);
  limit.memory_ = memory_limit;
  limit.checked_nodes_ = std::numeric_limits<std::uint64_t>::max();
  return limit;
}

std::optional<TreeEnd> GrowthLimit::reached(const Growth& now) {
  if (now.nodes >= most_.nodes) return TreeEnd::kNodes;
  if (now.memory >= memory_) return TreeEnd::kMemory;
  if (now.pivots >= most_.pivots) return TreeEnd::kPivots;
  if (mode_ == TreeMode::kAuto && now.pivots >= enough_ && now.worst <= short_) return TreeEnd::kPivots;
  if (mode_ == TreeMode::kAuto && now.bytes >= most_.bytes) return TreeEnd::kBytes;
  if (mode_ == TreeMode::kAuto && gainsLittle(now)) return TreeEnd::kLittleGain;
  return std::nullopt;
}

bool GrowthLimit::gainsLittle(const Growth& now) {
  if (now.nodes < checked_nodes_) return false;
  checked_nodes_ = 2 * now.nodes;
  const bool gains_little = checked_worst_ > 0 && static_cast<double>(now.worst) >
                                                      kLittleGain * static_cast<double>(checked_worst_);
  checked_worst_ = now.worst;
  return gains_little;
}

}  // namespace polyfly
