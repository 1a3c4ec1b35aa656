#include "certify/lookup/lookup_proof.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "certify/lookup/leaf_walk.hpp"
#include "certify/shared_loop.hpp"

namespace polyfly {
namespace {

constexpr std::size_t kMostLeafCells = 20000;  // of one leaf

struct LeafResult {
  std::string text;
  std::vector<Defect> defects;
};

template <typename Archive>
void members(Archive& archive, LeafResult& leaf) {
  archive(leaf.text, leaf.defects);
}

Defect lookupDefect(std::string text) {
  Defect defect;
  defect.kind = Defect::Kind::kLookup;
  defect.text = std::move(text);
  return defect;
}

class LeafProver {
 public:
  LeafProver(const LookupContext& context, const std::vector<BoundaryRow>& boundary, std::size_t visit)
      : context_(context),
        boundary_(boundary),
        visit_(visit),
        name_("leaf " + std::to_string(context.tree.leaf(visit))) {}

  LeafResult prove() {
    LeafResult result;
    if (context_.tree.namesTwice(visit_)) {
      result.defects.push_back(lookupDefect(name_ + ": names a region twice"));
      return result;
    }
    if (!LeafWalk(context_, visit_).prove(result.text)) cover(result);
    return result;
  }

 private:
  /// Proves it without a walk, for which no starting point may be deep enough.
  void cover(LeafResult& result) const {
    const WholePlanes& planes = context_.planes;
    std::vector<ExactRow> path;
    for (const std::int32_t row : context_.tree.path(visit_))
      path.push_back(planes.moved(row, planes.rounding()));
    CandidateCover cover(context_, context_.check.map.leaf(context_.tree.leaf(visit_)),
                         planes.tolerance() - 2 * planes.rounding(), &boundary_, kMostLeafCells);
    ExactRows cell;
    for (const ExactRow& row : path) cell.push_back(&row);
    std::string proof = "leaf cover";
    if (cover.cover(std::move(cell), proof)) {
      result.text = proof + "\n";
    } else if (!context_.check.stopped()) {
      addGap(cover.uncovered(), result.defects);
    }
  }

  void addGap(const std::vector<Rational>& witness, std::vector<Defect>& defects) const {
    Defect defect =
        lookupDefect(name_ + (witness.empty() ? ": is not proven to answer all that arrives there"
                                              : ": no candidate holds a parameter that arrives there"));
    if (!witness.empty()) defect.witness = context_.check.program.theta(witness);
    defects.push_back(std::move(defect));
  }

  const LookupContext& context_;
  const std::vector<BoundaryRow>& boundary_;
  std::size_t visit_;
  std::string name_;
};

void addUnbounded(const LookupTree& tree, std::uint32_t region, const UnboundedRow& row,
                  std::vector<Defect>& defects) {
  Defect defect =
      lookupDefect("leaf " + std::to_string(tree.leaf(row.visit)) + ": a look-up does not test row " +
                   std::to_string(row.row) + " of region " + std::to_string(region) +
                   ", and may answer further beyond it than " + std::to_string(kReach) + " tolerances");
  defect.region = region;
  defect.row = static_cast<int>(row.row);
  defect.size = row.reach;
  defects.push_back(std::move(defect));
}

enum class Half { kDrops, kLeaves };

/// The proof of look-ups is the last third of certify's progress, which counts regions three times.
std::function<void(std::uint64_t, std::uint64_t)> lookupProgress(const CertifyOptions& options,
                                                                 std::uint64_t regions, Half half) {
  if (!options.progress) return {};
  return [&options, regions, half](std::uint64_t done, std::uint64_t count) {
    const std::uint64_t share =
        regions * (done + (half == Half::kLeaves ? count : 0)) / std::max<std::uint64_t>(1, 2 * count);
    options.progress(2 * regions + share, 3 * regions);
  };
}

/// Rules of the whole map without which check_certificate confirms nothing.
void checkHeader(const CheckContext& context, const WholePlanes& planes, std::vector<Defect>& defects) {
  const RegionMap& map = context.map;
  const auto require = [&](bool holds, const std::string& text) {
    if (!holds) defects.push_back(lookupDefect(text));
  };
  const std::string status(map.solverStatus());
  require(status == "complete", "the map's status is '" + status + "', not 'complete'");
  require(2 * context.options.plane_tolerance <= map.tolerance(),
          "the map's tolerance is less than twice that of its planes");
  require(planes.tooRough().empty(), planes.tooRough());
}

}  // namespace

bool proveLookups(const CheckContext& context, const std::vector<RegionCheck>& checks,
                  const std::vector<std::vector<FacetBehind>>& behind, bool widened, std::string& text,
                  std::vector<Defect>& defects) {
  const WholePlanes planes(context.map, context.program);
  checkHeader(context, planes, defects);
  const LookupTree tree(context.map);
  std::vector<RegionDrops> drops(context.map.regionCount());
  const CertifyOptions& options = context.options;
  if (!fillShared<RegionDrops>(
          drops, options, lookupProgress(options, drops.size(), Half::kDrops),
          [&](std::uint32_t region) { return dropRows(context.map, planes, tree, region); }))
    return false;
  const LookupContext lookup{context, checks, behind, planes, tree, drops, widened};
  const std::vector<BoundaryRow> boundary = boundaryRows(lookup);
  std::vector<LeafResult> leaves(tree.size());
  const auto prove = [&](std::uint32_t visit) {
    return tree.isLeaf(visit) ? LeafProver(lookup, boundary, visit).prove() : LeafResult();
  };
  if (!fillShared<LeafResult>(leaves, options, lookupProgress(options, drops.size(), Half::kLeaves), prove))
    return false;
  for (std::uint32_t region = 0; region < drops.size(); ++region) {
    text += drops[region].text;
    for (const UnboundedRow& row : drops[region].unbounded) addUnbounded(tree, region, row, defects);
  }
  for (std::size_t visit = 0; visit < tree.size(); ++visit) {
    text += leaves[visit].text;
    defects.insert(defects.end(), leaves[visit].defects.begin(), leaves[visit].defects.end());
    leaves[visit] = {};
  }
  return true;
}

}  // namespace polyfly
