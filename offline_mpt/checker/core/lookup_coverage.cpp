// Statement 6, second half: a look-up misses no parameter with a solution, but next to the boundary.
#include <algorithm>

#include "core/lookups.hpp"
#include "core/tags.hpp"

namespace checker {
namespace {

constexpr std::size_t kStatus = 3;  // place among the strings of a map

}  // namespace

Lookups::Lookups(const Map& map, const Fraction& plane_tolerance, const std::vector<ProvenRegion>& regions,
                 RowsOfRegion rows)
    : LookupAnswers(map), regions_(regions), rows_(std::move(rows)), plane_tolerance_(plane_tolerance) {
  require(map_.reduced_from == 0, "the map was reduced");
  require(map_.words[kStatus] == "complete", "the map's status is not complete");
}

void Lookups::check(const std::vector<std::string>& lines, const Progress& progress) {
  std::size_t next = 0;
  for (; next < lines.size(); ++next) {
    Line line(lines[next]);
    if (!line.next("drop")) break;
    readDrop(line);
    line.end();
  }
  checkLeaves(progress, [&] { checkCoverage(lines, next); });
  require(next == lines.size(), "there are more proofs of look-ups than leaves");
}

void Lookups::checkCoverage(const std::vector<std::string>& lines, std::size_t& next) {
  known_ = {candidates_.begin(), candidates_.end()};
  require(next < lines.size(), "a leaf has no proof");
  Line line(lines[next++]);
  require(line.word() == "leaf", "a leaf has no proof");
  if (line.next("walk")) return checkWalk(line, lines, next);
  require(line.next("cover"), "a leaf has a proof of another kind");
  std::vector<Row> path;
  for (const std::int32_t row : path_) path.push_back(movedRow(row, rounding_));
  std::vector<const Row*> cell;
  for (const Row& row : path) cell.push_back(&row);
  checkCover(line, cell, {tolerance_ - 2 * rounding_, true});
  line.end();
}

/// The cell is empty, or cut by the rows that are tested in a candidate: what lies outside of each is covered. Or it is
/// cut by a boundary row, moved inwards by the tolerance.
void Lookups::checkCover(Line& line, std::vector<const Row*> cell, const CoverBy& by) const {
  require(cell.size() < kMostCellRows, "a cover is nested too deeply");
  const std::string kind = line.word();
  if (kind == tag::kEmpty) return requireEmpty(line, cell, nullptr);
  if (kind == tag::kCutByBoundary && by.boundary) {
    const std::size_t region = line.count(map_.regions.size() - 1), facet = line.count(kMany);
    const std::int32_t signed_row = rowOf(region, facet);
    require(regions_[region].facets[facet].is_boundary, "a cut by what is no boundary");
    const Row row = movedRow(signed_row, -tolerance_);
    cell.push_back(&row);
    return checkCover(line, cell, by);
  }
  require(kind == tag::kCutByRegion, kind + " covers nothing");
  const std::size_t place = line.count(kMany);
  require(place < candidates_.size(), "a part is left to what is no candidate");
  const std::size_t region = candidates_[place];
  std::vector<Row> rows;
  for (std::size_t i = 0; i < map_.regions[region].row_count; ++i) {
    if (isTested(tests_[place], i)) rows.push_back(movedRow(rowOf(region, i), by.reach));
  }
  for (const Row& row : rows) {
    const Row other_side = negated(row);
    std::vector<const Row*> outside = cell;
    outside.push_back(&other_side);
    checkCover(line, outside, by);
    cell.push_back(&row);
  }
}

void Lookups::checkWalk(Line& line, const std::vector<std::string>& lines, std::size_t& next) {
  checkStart(line);
  line.end();
  path_inside_.clear();
  for (std::size_t k = 0; k < path_.size(); ++k) path_inside_.push_back(movedRow(path_[k], -depths_[k]));
  near_.clear();
  beginWalk();
  for (; next < lines.size(); ++next) {
    Line proof(lines[next]);
    if (!readWalk(proof) && !readFurther(proof)) break;
    proof.end();
  }
  for (const std::size_t region : candidates_) checkBehind(region, true);
  for (const std::size_t region : near_) checkBehind(region, false);
}

bool Lookups::readWalk(Line& line) {
  if (line.next("outside")) {
    readOutside(line);
    return true;
  }
  if (!line.next("near")) return false;
  readNear(line);
  return true;
}

/// A point c inside of a candidate, and a share s. What arrives at the leaf can be moved towards c by the share s of the
/// way. There a path row is at least s (d + e) - e, with d at c. On this way a tested row changes by at most
/// s (|row at c| + T), which must be within `room`.
void Lookups::checkStart(Line& line) {
  const std::size_t place = line.count(kMany);
  require(place < candidates_.size(), "a walk starts in what is no candidate");
  const Fraction share = line.fraction();
  require(share > 0, "the share of a walk is not positive");
  Vector point;
  while (!line.done()) point.push_back(line.fraction());
  require(point.size() == map_.p, "the starting point is missing");
  for (const Fraction& value : point) require(abs(value) < 1, "the starting point lies outside of the box");
  for (const Row& row : conditions(candidates_[place]))
    require(valueAt(row, point) > 0, "the starting point does not lie inside");
  const auto at_point = [&](std::int32_t row) { return valueAt(mapRow(row), point); };
  depths_.clear();
  for (const std::int32_t row : path_) {
    const Fraction deep = at_point(row);
    require(deep > 0, "the starting point does not lie in the leaf");
    depths_.push_back(-roundedUp(-share * (deep + rounding_)) - rounding_);
  }
  Fraction greatest, error;
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const std::size_t region = candidates_[k];
    error = std::max(error, regions_[region].plane_error);
    for (std::size_t i = 0; i < map_.regions[region].row_count; ++i) {
      if (isTested(tests_[k], i)) greatest = std::max(greatest, Fraction(abs(at_point(rowOf(region, i)))));
    }
  }
  const Fraction room = tolerance_ - 2 * rounding_ - plane_tolerance_ - error;
  require(share * (greatest + tolerance_) <= room, "the starting point is not deep enough");
}

std::vector<const Row*> Lookups::cellWith(const std::vector<Row>& rows) const {
  std::vector<const Row*> cell;
  for (const Row& row : path_inside_) cell.push_back(&row);
  for (const Row& row : rows) cell.push_back(&row);
  return cell;
}

void Lookups::readOutside(Line& line) {
  const std::size_t region = line.count(regions_.size() - 1);
  const std::vector<Row> rows = rows_(region);
  requireEmpty(line, cellWith(rows), nullptr);
  known_.insert(region);
}

/// The region, where it reaches into the leaf, lies within the plane tolerance of candidates' tested rows.
void Lookups::readNear(Line& line) {
  const std::size_t region = line.count(regions_.size() - 1);
  const std::vector<Row> rows = rows_(region);
  checkCover(line, cellWith(rows), {plane_tolerance_, false});
  known_.insert(region);
  near_.push_back(region);
}

/// Behind each facet lie candidates, or nothing that matters at the leaf.
void Lookups::checkBehind(std::size_t region, bool is_candidate) const {
  const std::vector<FacetBehind>& facets = regions_[region].facets;
  for (std::size_t facet = 0; facet < facets.size(); ++facet) {
    const auto is_known = [&](std::size_t other) { return known_.count(other) > 0; };
    const std::vector<std::size_t>& behind = facets[facet].regions;
    require(facets[facet].is_boundary || std::all_of(behind.begin(), behind.end(), is_known) ||
                (is_candidate && isOutside(region, facet)),
            "region " + std::to_string(region) + ": what lies behind facet " + std::to_string(facet) +
                " is no candidate");
  }
}

/// Whether the facet has no point in the part of the leaf.
bool Lookups::isOutside(std::size_t region, std::size_t facet) const {
  if (facet >= map_.regions[region].row_count) return false;
  const Fraction& error = regions_[region].plane_error;
  const auto on_path = std::find(path_.begin(), path_.end(), rowOf(region, facet));
  if (on_path != path_.end()) return depths_[static_cast<std::size_t>(on_path - path_.begin())] >= error;
  if (!dropsShowOutside()) return false;
  const Fraction least = path_.empty() ? Fraction(1) : *std::min_element(depths_.begin(), depths_.end());
  const std::vector<const Drop*> drops = dropsOf(region);
  return std::any_of(drops.begin(), drops.end(), [&](const Drop* drop) {
    return drop->row == facet && drop->constant + least * drop->path_weight >= error * (1 + drop->row_weight);
  });
}

}  // namespace checker
