#include "certify/reduction/reduced_answers.hpp"

#include "certify/lookup/dropped_rows.hpp"
#include "certify/lookup/lookup_tree.hpp"
#include "certify/lookup/whole_planes.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

bool testsAllRows(const RegionMap& map) { return map.leafCount() == 0 || map.leaf(0).tests == nullptr; }

ReductionDefect defectOf(const std::string& text) {
  ReductionDefect defect;
  defect.kind = ReductionDefect::Kind::kAnswer;
  defect.text = text;
  return defect;
}

ReductionDefect defectOf(const LookupTree& tree, std::uint32_t region, const UnboundedRow& row) {
  ReductionDefect defect =
      defectOf("region " + std::to_string(region) + " of the reduced map: leaf " +
               std::to_string(tree.leaf(row.visit)) + " does not test row " + std::to_string(row.row) +
               ", and may answer further beyond it than " + std::to_string(kReach) + " tolerances");
  defect.region = region;
  defect.leaf = static_cast<int>(tree.leaf(row.visit));
  defect.row = static_cast<int>(row.row);
  return defect;
}

}  // namespace

bool proveAnswers(const RegionMap& reduced, const ReductionOptions& options, std::string& text,
                  std::vector<ReductionDefect>& defects) {
  if (testsAllRows(reduced)) return true;
  const WholePlanes planes(reduced, ExactRanges(reduced.parameters()));
  if (!planes.tooRough().empty()) {
    defects.push_back(defectOf("leaves of the reduced map test some rows only, but " + planes.tooRough()));
    return true;
  }
  const LookupTree tree(reduced);
  for (std::size_t visit = 0; visit < tree.size(); ++visit) {
    if (!tree.isLeaf(visit) || !tree.namesTwice(visit)) continue;
    defects.push_back(
        defectOf("leaf " + std::to_string(tree.leaf(visit)) + " of the reduced map names a region twice"));
    defects.back().leaf = static_cast<int>(tree.leaf(visit));
  }
  std::vector<RegionDrops> drops(reduced.regionCount());
  const bool finished =
      inParallel(drops.size(), options.threads, options.stop, {}, [&](std::size_t, std::uint64_t i) {
        drops[i] = dropRows(reduced, planes, tree, static_cast<std::uint32_t>(i));
      });
  if (!finished) return false;
  for (std::uint32_t region = 0; region < drops.size(); ++region) {
    text += drops[region].text;
    for (const UnboundedRow& row : drops[region].unbounded) defects.push_back(defectOf(tree, region, row));
  }
  return true;
}

}  // namespace polyfly
