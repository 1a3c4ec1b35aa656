#include "offline_mpt/diff.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "arithmetic/exact_numbers.hpp"
#include "certify/farkas_proof.hpp"
#include "diff/linear_maximum.hpp"
#include "diff/map_cells.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"

namespace polyfly {
namespace {

/// What was found about one region of the first map.
struct RegionDifferences {
  // Regions of the second map that meet it, ascending.
  std::vector<std::uint32_t> met;
  // The greatest difference of each input and each met region that is not zero.
  std::vector<LawDifference> differences;
};

class MapComparison {
 public:
  MapComparison(const MapCells& first, const MapCells& second, const std::vector<Signal>& ranges)
      : first_(first), second_(second), inputs_(first.exact().map().inputs().size()), ranges_(ranges) {}

  RegionDifferences compare(const MapCell& cell) const {
    RegionDifferences result;
    for (const std::uint32_t candidate : meeting(second_.regions(), cell.box)) {
      const MapCell& other = second_.regions()[candidate];
      if (areOpposed(cell, other)) continue;
      std::vector<const ExactRow*> rows = cell.cell.rows;
      rows.insert(rows.end(), other.cell.rows.begin(), other.cell.rows.end());
      if (!hasInterior(rows)) continue;
      result.met.push_back(other.region);
      for (std::size_t input = 0; input < inputs_; ++input) {
        LawDifference difference = greatest(rows, cell.region, other.region, input);
        if (difference.size > 0.0) result.differences.push_back(std::move(difference));
      }
    }
    return result;
  }

 private:
  bool hasInterior(const std::vector<const ExactRow*>& rows) const {
    const int p = first_.exact().p();
    // Most pairs are well apart, and need no exact number.
    if (upperBound(rows, std::vector<double>(static_cast<std::size_t>(p))) < 0.0) return false;
    std::vector<Rational> point;
    const FastInterior fast = findInteriorFast(rows, p, point);
    if (fast != FastInterior::kUnknown) return fast == FastInterior::kExists;
    return findInterior(rows, nullptr, p).exists;
  }

  /// Whether a plane that both maps have separates the regions: true of most neighbours, and found without a program.
  bool areOpposed(const MapCell& cell, const MapCell& other) const {
    const RegionView region = second_.exact().map().region(other.region);
    return std::any_of(region.rows, region.rows + region.row_count, [&](std::int32_t row) {
      const ExactRow* const opposite = &second_.exact().row(-row);
      return std::find(cell.cell.rows.begin(), cell.cell.rows.end(), opposite) != cell.cell.rows.end();
    });
  }

  /// Where |u - u'| of an input is greatest; size 0 and no theta where the laws are the same.
  LawDifference greatest(const std::vector<const ExactRow*>& rows, std::uint32_t first, std::uint32_t second,
                         std::size_t input) const {
    LawDifference result;
    result.input = static_cast<int>(input);
    result.first_region = first;
    result.second_region = second;
    const std::size_t p = ranges_.half.size();
    const RegionMap& map = first_.exact().map();
    const RegionMap& other = second_.exact().map();
    const double* const u = map.law(map.region(first).law) + input * (p + 1);
    const double* const v = other.law(other.region(second).law) + input * (p + 1);
    if (std::equal(u, u + p + 1, v)) return result;
    std::vector<Rational> difference = ranges_.inBox(u, u[p]), opposite;
    const std::vector<Rational> other_law = ranges_.inBox(v, v[p]);
    for (std::size_t j = 0; j <= p; ++j) {
      difference[j] -= other_law[j];
      opposite.emplace_back(-difference[j]);
    }
    LinearMaximum maximum = maximise(rows, difference);
    LinearMaximum minimum = maximise(rows, opposite);
    const LinearMaximum& worst = maximum.value >= minimum.value ? maximum : minimum;
    result.size = above(worst.value);
    result.theta = first_.exact().theta(worst.t);
    return result;
  }

  const MapCells& first_;
  const MapCells& second_;
  std::size_t inputs_;
  ExactRanges ranges_;
};

/// For each region of a map, the regions of another one whose interiors meet its, ascending.
using MeetingRegions = std::vector<std::vector<std::uint32_t>>;

/// Whether `map` answers wherever a region of another one does. `witness`: where it does not.
class CoverCheck {
 public:
  /// `meeting` by regions of the other map.
  CoverCheck(const MapCells& map, const MeetingRegions& meeting) : map_(map), meeting_(meeting) {
    for (const MapCell& region : map.regions()) all_.push_back(region.region);
  }

  bool covers(const MapCell& region, std::vector<Rational>& witness) const {
    const ExactCell& cell = region.cell;
    for (const ExactRow& side : map_.sides()) {
      const ExactRow outside = opposite(side);
      std::vector<const ExactRow*> rows = cell.rows;
      rows.push_back(&outside);
      Interior interior = findInterior(rows, nullptr, map_.exact().p());
      if (interior.exists) {
        witness = std::move(interior.point);
        return false;
      }
    }
    // Regions that only touch, or lie within the tolerance, matter in slivers alone.
    if (isIn(cell, meeting_[region.region], witness)) return true;
    std::vector<std::uint32_t> near;
    for (const std::uint32_t i : meeting(map_.regions(), region.box))
      near.push_back(map_.regions()[i].region);
    return isIn(cell, near, witness) || isIn(cell, all_, witness);
  }

 private:
  bool isIn(const ExactCell& cell, const std::vector<std::uint32_t>& regions,
            std::vector<Rational>& witness) const {
    ProofWriter log;
    const auto visit = [&](const ExactCell& rest) {
      ExactCell settled = rest;
      if (!makeCertain(map_.exact(), settled)) return true;
      witness = settled.point;
      return false;
    };
    return subtract(map_.exact(), cell, regions, CutBy::kOriginal, visit, log);
  }

  const MapCells& map_;
  const MeetingRegions& meeting_;
  // Regions of the map that have an interior.
  std::vector<std::uint32_t> all_;
};

/// Looks at the regions of the other map up to the first that is not covered; false when stopped.
bool findCover(const CoverCheck& check, const MapCells& other, const DiffOptions& options, MapCover& cover) {
  std::mutex mutex;
  std::uint64_t first_open = other.regions().size();
  std::vector<Rational> witness;
  const auto look = [&](std::size_t, std::uint64_t i) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      if (i > first_open) return;
    }
    std::vector<Rational> point;
    if (check.covers(other.regions()[i], point)) return;
    const std::lock_guard<std::mutex> lock(mutex);
    if (i > first_open) return;
    first_open = i;
    witness = std::move(point);
  };
  const bool finished =
      inParallel(other.regions().size(), options.threads, options.stop, options.progress, look);
  if (!finished || witness.empty()) return finished;
  cover.covers = false;
  cover.region = other.regions()[first_open].region;
  cover.witness = other.exact().theta(witness);
  return true;
}

void fillDifferences(std::vector<RegionDifferences>& found, DiffReport& report) {
  const LawDifference* last = nullptr;
  for (RegionDifferences& region : found) {
    for (LawDifference& difference : region.differences) {
      LawDifference& greatest = report.greatest[static_cast<std::size_t>(difference.input)];
      if (difference.size > greatest.size) greatest = difference;
      if (difference.size > report.tolerance) report.differences.push_back(std::move(difference));
    }
  }
  for (const LawDifference& difference : report.differences) {
    const bool is_new = last == nullptr || last->first_region != difference.first_region ||
                        last->second_region != difference.second_region;
    report.different_pairs += is_new ? 1 : 0;
    last = &difference;
  }
}

}  // namespace

DiffReport diffMaps(const RegionMap& first, const RegionMap& second, const DiffOptions& options) {
  const std::vector<Signal> ranges = commonRanges(first, second);
  const MapCells cells(first, ranges, nullptr, options.threads);
  const MapCells others(second, ranges, &cells, options.threads);
  DiffReport report;
  report.first_regions = first.regionCount();
  report.second_regions = second.regionCount();
  report.tolerance = options.tolerance;
  report.greatest.resize(first.inputs().size());
  for (std::size_t i = 0; i < report.greatest.size(); ++i) report.greatest[i].input = static_cast<int>(i);
  const MapComparison comparison(cells, others, ranges);
  std::vector<RegionDifferences> found(cells.regions().size());
  const bool compared =
      inParallel(found.size(), options.threads, options.stop, options.progress,
                 [&](std::size_t, std::uint64_t i) { found[i] = comparison.compare(cells.regions()[i]); });
  MeetingRegions of_first(first.regionCount()), of_second(second.regionCount());
  for (std::size_t i = 0; i < found.size(); ++i) {
    const std::uint32_t region = cells.regions()[i].region;
    of_first[region] = found[i].met;
    for (const std::uint32_t other : found[i].met) of_second[other].push_back(region);
    report.pairs += found[i].met.size();
  }
  report.interrupted =
      !compared || !findCover(CoverCheck(cells, of_second), others, options, report.first_covers_second) ||
      !findCover(CoverCheck(others, of_first), cells, options, report.second_covers_first);
  fillDifferences(found, report);
  return report;
}

}  // namespace polyfly
