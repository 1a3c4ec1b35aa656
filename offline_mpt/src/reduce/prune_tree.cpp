#include "reduce/prune_tree.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "reduce/rewrite_tree.hpp"
#include "tree/member_solver.hpp"
#include "tree/tree_leaves.hpp"

namespace polyfly {
namespace {

/// What a map holds of a leaf.
struct LeafContent {
  std::vector<std::uint32_t> candidates;
  /// The rows to test of each, as MapContent::tests.
  std::vector<std::uint32_t> tests;
};

using Candidates = std::vector<std::uint32_t>;  // ascending

class Pruner final : public TreeRewriter<LeafContent> {
 public:
  Pruner(CellGeometry& geometry, const TreeRegions& regions, const std::vector<std::uint32_t>& laws,
         double slack, double side_tolerance, const SearchTree& tree)
      : TreeRewriter(tree),
        geometry_(geometry),
        regions_(regions),
        laws_(laws),
        slack_(slack),
        solver_(regions, side_tolerance),
        writer_(result_) {}

 private:
  LeafContent leafAt(std::uint32_t number) override { return prune(tree_.leaves[number]); }

  std::uint32_t numberOf(const LeafContent& leaf) override {
    return writer_.write(leaf.candidates.data(), leaf.tests.data(),
                         static_cast<std::uint32_t>(leaf.candidates.size()));
  }

  /// If one leaf has all candidates of the other and no look-up gets longer.
  std::optional<LeafContent> join(const LeafContent& below, const LeafContent& above) override {
    const Candidates &first = below.candidates, &second = above.candidates;
    LeafContent joined;
    if (std::includes(first.begin(), first.end(), second.begin(), second.end()))
      joined.candidates = first;
    else if (std::includes(second.begin(), second.end(), first.begin(), first.end()))
      joined.candidates = second;
    else
      return std::nullopt;
    for (const std::uint32_t region : joined.candidates)
      joined.tests.push_back(tree_.tests.empty() ? testsOfAll(rowCount(region))
                                                 : solver_.testsAt(region, path_));
    if (cost(joined) > std::max(cost(below), cost(above)) + 1) return std::nullopt;
    return joined;
  }

  std::size_t cost(const LeafContent& leaf) const {
    std::size_t sum = 0;
    for (std::size_t i = 0; i < leaf.tests.size(); ++i)
      sum += testedRows(leaf.tests[i], rowCount(leaf.candidates[i]));
    return sum;
  }

  std::uint32_t rowCount(std::uint32_t region) const {
    return static_cast<std::uint32_t>(regions_.rows[region].size());
  }

  LeafContent prune(const MapContent::Leaf& leaf) {
    std::map<std::uint32_t, std::uint32_t> tests;  // by candidate
    Candidates candidates;
    for (std::size_t k = leaf.first; k < std::size_t{leaf.first} + leaf.count; ++k) {
      candidates.push_back(tree_.candidates[k]);
      const std::uint32_t region = candidates.back();
      tests[region] = tree_.tests.empty() ? testsOfAll(rowCount(region)) : tree_.tests[k];
    }
    std::sort(candidates.begin(), candidates.end());
    for (std::size_t i = candidates.size(); i-- > 0 && candidates.size() > 1;) {
      std::vector<const RowList*> cover;
      for (const std::uint32_t other : candidates) {
        if (other != candidates[i] && laws_[other] == laws_[candidates[i]])
          cover.push_back(&regions_.rows[other]);
      }
      if (!cover.empty() && isCovered(candidates[i], cover))
        candidates.erase(candidates.begin() + static_cast<std::ptrdiff_t>(i));
    }
    LeafContent result;
    for (const std::uint32_t region : candidates) result.tests.push_back(tests[region]);
    result.candidates = std::move(candidates);
    return result;
  }

  bool isCovered(std::uint32_t region, const std::vector<const RowList*>& cover) {
    ConvexCell part;
    part.rows = regions_.rows[region];
    part.rows.insert(part.rows.end(), path_.begin(), path_.end());
    geometry_.describe(part);
    return part.radius > 0.0 && geometry_.covered(part, cover, slack_);
  }

  CellGeometry& geometry_;
  const TreeRegions& regions_;
  const std::vector<std::uint32_t>& laws_;
  double slack_;
  MemberSolver solver_;
  LeafWriter writer_;
};

}  // namespace

SearchTree pruneTree(CellGeometry& geometry, const TreeRegions& regions,
                     const std::vector<std::uint32_t>& laws, double slack, double side_tolerance,
                     const SearchTree& tree) {
  SearchTree pruned = Pruner(geometry, regions, laws, slack, side_tolerance, tree).run();
  pruned.worst = worstLookUp(pruned, regions);
  if (tree.tests.empty()) pruned.tests.clear();
  return pruned;
}

}  // namespace polyfly
