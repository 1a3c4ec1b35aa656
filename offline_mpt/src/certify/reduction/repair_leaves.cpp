#include <algorithm>
#include <cstddef>
#include <map>
#include <vector>

#include "offline_mpt/verify_reduction.hpp"

namespace polyfly {
namespace {

/// Candidates of a leaf, and the rows that are tested of each.
using LeafTests = std::map<std::uint32_t, std::uint32_t>;

std::vector<LeafTests> readLeaves(const MapContent& content) {
  std::vector<LeafTests> leaves;
  for (const MapContent::Leaf& leaf : content.leaves) {
    leaves.emplace_back();
    for (std::size_t k = leaf.first; k < std::size_t{leaf.first} + leaf.count; ++k)
      leaves.back()[content.candidates[k]] = content.tests.empty() ? MapContent::kAllRows : content.tests[k];
  }
  return leaves;
}

void writeLeaves(const std::vector<LeafTests>& leaves, MapContent& content) {
  const bool has_tests = !content.tests.empty();
  content.candidates.clear();
  content.tests.clear();
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    content.leaves[i] = {static_cast<std::uint32_t>(content.candidates.size()),
                         static_cast<std::uint32_t>(leaves[i].size())};
    for (const auto& [region, tests] : leaves[i]) {
      content.candidates.push_back(region);
      if (has_tests) content.tests.push_back(tests);
    }
  }
}

bool repair(const ReductionDefect& defect, const MapContent& content, LeafTests& leaf) {
  const LeafTests before = leaf;
  for (const std::uint32_t region : defect.missing)
    leaf.emplace(region, testsOfAll(content.regions[region].row_count));
  if (defect.row >= 0) leaf[defect.region] |= 1u << std::min(defect.row, 31);
  return leaf != before;
}

}  // namespace

bool repairLeaves(MapContent& content, const ReductionReport& report) {
  std::vector<LeafTests> leaves = readLeaves(content);
  bool repaired = false;
  for (const ReductionDefect& defect : report.defects) {
    if (defect.leaf >= 0) {
      repaired |= repair(defect, content, leaves[static_cast<std::size_t>(defect.leaf)]);
    } else if (defect.kind == ReductionDefect::Kind::kAnswer && !content.tests.empty()) {
      content.tests.clear();
      repaired = true;
    }
  }
  if (repaired) writeLeaves(leaves, content);
  return repaired;
}

}  // namespace polyfly
