#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "offline_mpt/verify_reduction.hpp"

namespace polyfly {
namespace {

/// Candidates in the order of the leaves, without those that no leaf has any more.
void packLeaves(MapContent& content) {
  std::vector<std::uint32_t> packed;
  for (MapContent::Leaf& leaf : content.leaves) {
    const auto first = content.candidates.begin() + static_cast<std::ptrdiff_t>(leaf.first);
    leaf.first = static_cast<std::uint32_t>(packed.size());
    packed.insert(packed.end(), first, first + static_cast<std::ptrdiff_t>(leaf.count));
  }
  content.candidates = std::move(packed);
}

}  // namespace

bool repairLeaves(MapContent& content, const ReductionReport& report) {
  std::map<std::size_t, std::set<std::uint32_t>> leaves;
  for (const ReductionDefect& defect : report.defects) {
    if (defect.leaf >= 0)
      leaves[static_cast<std::size_t>(defect.leaf)].insert(defect.missing.begin(), defect.missing.end());
  }
  bool repaired = false;
  for (auto& [index, candidates] : leaves) {
    MapContent::Leaf& leaf = content.leaves[index];
    const auto first = content.candidates.begin() + static_cast<std::ptrdiff_t>(leaf.first);
    const std::set<std::uint32_t> before(first, first + static_cast<std::ptrdiff_t>(leaf.count));
    candidates.insert(before.begin(), before.end());
    if (candidates.size() == before.size()) continue;
    leaf = {static_cast<std::uint32_t>(content.candidates.size()),
            static_cast<std::uint32_t>(candidates.size())};
    content.candidates.insert(content.candidates.end(), candidates.begin(), candidates.end());
    repaired = true;
  }
  if (repaired) packLeaves(content);
  return repaired;
}

}  // namespace polyfly
