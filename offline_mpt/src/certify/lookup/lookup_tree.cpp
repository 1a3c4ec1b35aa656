#include "certify/lookup/lookup_tree.hpp"

#include <algorithm>

namespace polyfly {
namespace {

/// Sorts by region, and joins what is said of one region.
void unite(std::vector<TreeMember>& members) {
  std::stable_sort(members.begin(), members.end(),
                   [](const TreeMember& a, const TreeMember& b) { return a.region < b.region; });
  std::size_t kept = 0;
  for (const TreeMember& member : members) {
    if (kept > 0 && members[kept - 1].region == member.region) {
      members[kept - 1].tests |= member.tests;
    } else {
      members[kept++] = member;
    }
  }
  members.resize(kept);
  members.shrink_to_fit();
}

}  // namespace

LookupTree::LookupTree(const RegionMap& map) {
  visits_.reserve(map.nodeCount() + map.leafCount());
  std::vector<Visit> open{{map.root(), 0, 0, 0, {}, false}};
  while (!open.empty()) {
    const std::size_t index = visits_.size();
    visits_.push_back(std::move(open.back()));
    open.pop_back();
    if (index > 0 && visits_.back().row < 0) visits_[visits_.back().parent].above = index;
    const std::uint32_t child = visits_.back().child;
    if ((child & MapContent::kLeaf) != 0) continue;
    const MapContent::Node& node = map.node(child);
    const auto row = static_cast<std::int32_t>(node.plane) + 1;
    open.push_back({node.above, index, 0, -row, {}, false});
    open.push_back({node.below, index, 0, row, {}, false});
  }
  for (std::size_t i = visits_.size(); i-- > 0;) {
    Visit& visit = visits_[i];
    if (isLeaf(i)) addLeafMembers(map, visit);
    const std::size_t named = visit.members.size();
    unite(visit.members);
    visit.names_twice = isLeaf(i) && visit.members.size() < named;
    std::vector<TreeMember>& above = visits_[visit.parent].members;
    if (i > 0) above.insert(above.end(), visit.members.begin(), visit.members.end());
  }
}

void LookupTree::addLeafMembers(const RegionMap& map, Visit& visit) const {
  const LeafView leaf = map.leaf(visit.child & ~MapContent::kLeaf);
  for (std::uint32_t k = 0; k < leaf.count; ++k)
    visit.members.push_back({leaf.candidates[k], leaf.testsOf(k)});
}

std::vector<std::int32_t> LookupTree::path(std::size_t visit) const {
  std::vector<std::int32_t> rows;
  for (; visit != 0; visit = visits_[visit].parent) rows.push_back(visits_[visit].row);
  std::reverse(rows.begin(), rows.end());
  return rows;
}

const TreeMember* LookupTree::member(std::size_t visit, std::uint32_t region) const {
  const std::vector<TreeMember>& members = visits_[visit].members;
  const auto at = std::lower_bound(members.begin(), members.end(), region,
                                   [](const TreeMember& a, std::uint32_t r) { return a.region < r; });
  return at != members.end() && at->region == region ? &*at : nullptr;
}

}  // namespace polyfly
