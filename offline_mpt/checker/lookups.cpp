#include "lookups.hpp"

#include <algorithm>

namespace checker {
namespace {

constexpr int kReach = 8;       // tolerances by which a row that is not tested may be violated
constexpr int kWideBits = 26;   // look-ups accept no more than |t_j| <= 1 + 2^-26
constexpr int kUnitBits = 120;  // the rounding error is rounded up to a multiple of 2^-120
constexpr double kMostTolerance = 1e-8;
constexpr std::size_t kStatus = 3;  // place among the strings of a map

Fraction power(int exponent) {
  return exponent >= 0 ? Fraction(Integer(1) << static_cast<unsigned long>(exponent))
                       : Fraction(1) / Fraction(Integer(1) << static_cast<unsigned long>(-exponent));
}

bool tests(std::uint32_t bits, std::size_t row) { return (bits >> std::min<std::size_t>(row, 31) & 1u) != 0; }

template <class List, class Value>
bool contains(const List& list, const Value& value) {
  return std::find(list.begin(), list.end(), value) != list.end();
}

}  // namespace

Lookups::Lookups(const Map& map, const Fraction& plane_tolerance, const std::vector<ProvenRegion>& regions,
                 std::function<std::vector<Row>(std::size_t)> rows,
                 std::function<std::vector<Row>(std::size_t)> moved_rows,
                 std::function<std::vector<Row>(std::size_t)> conditions, bool moved)
    : map_(map),
      scaling_(map),
      tolerance_(map.tolerance),
      plane_tolerance_(plane_tolerance),
      regions_(regions),
      rows_(std::move(rows)),
      moved_rows_(std::move(moved_rows)),
      conditions_(std::move(conditions)),
      moved_(moved),
      drops_(map.regions.size()) {
  requirePlainMap();
  findRounding();
  walkTree();
}

void Lookups::requirePlainMap() const {
  require(map_.reduced_from == 0 && map_.first_fallback == 0, "the map was reduced");
  require(map_.words[kStatus] == "complete", "the map's status is not complete");
  require(tolerance_ > 0 && tolerance_ <= Fraction(kMostTolerance), "the map's tolerance is out of range");
}

/// Of the sum of p products and a constant, in any order, with or without fused operations.
void Lookups::findRounding() {
  Fraction greatest;
  for (std::size_t k = 0; k < map_.planes.size(); k += map_.p + 1) {
    Fraction size = abs(Fraction(map_.planes[k + map_.p]));
    for (std::size_t j = 0; j < map_.p; ++j)
      size += abs(Fraction(map_.planes[k + j])) *
              (abs(scaling_.centre[j]) + scaling_.half[j] * (1 + power(-kWideBits)));
    greatest = std::max(greatest, size);
  }
  const Fraction whole = ((map_.p + 3) * greatest * power(-53) + power(-1000)) * power(kUnitBits);
  Integer up;
  mpz_cdiv_q(up.get_mpz_t(), whole.get_num_mpz_t(), whole.get_den_mpz_t());
  rounding_ = up * power(-kUnitBits);
  require(4 * rounding_ <= tolerance_, "distances from planes are not computed precisely enough");
}

void Lookups::walkTree() {
  std::vector<Visit> open{{map_.root, 0, 0}};
  while (!open.empty()) {
    require(visits_.size() <= 2 * map_.nodes.size(), "a node has two parents");
    visits_.push_back(open.back());
    open.pop_back();
    const std::uint32_t child = visits_.back().child;
    if ((child & Map::kLeaf) != 0) continue;
    const Map::Node& node = map_.nodes[child];
    const auto row = static_cast<std::int32_t>(node.plane) + 1;
    open.push_back({node.above, visits_.size() - 1, -row});
    open.push_back({node.below, visits_.size() - 1, row});
  }
}

std::vector<std::int32_t> Lookups::pathTo(std::size_t visit) const {
  std::vector<std::int32_t> path;
  for (; visit != 0; visit = visits_[visit].parent) path.push_back(visits_[visit].row);
  std::reverse(path.begin(), path.end());
  return path;
}

/// The inner side of a signed row: row (t, 1) >= 0.
Vector Lookups::mapRow(std::int32_t row) const {
  const double* plane = map_.planes.data() + (static_cast<std::size_t>(std::abs(row)) - 1) * (map_.p + 1);
  const int sign = row > 0 ? -1 : 1;
  return scaling_.inBox(plane, sign, -sign * Fraction(plane[map_.p]));
}

Row Lookups::movedRow(std::int32_t row, const Fraction& outwards) const {
  Vector values = mapRow(row);
  values.back() += outwards;
  return primitive(values);
}

Fraction Lookups::leastInWideBox(const Vector& row) const {
  Fraction sides;
  for (std::size_t j = 0; j < map_.p; ++j) sides += abs(row[j]);
  return row.back() - sides * (1 + power(-kWideBits));
}

std::int32_t Lookups::rowOf(std::size_t region, std::size_t row) const {
  require(row < map_.regions[region].row_count, "a proof names a row that is not there");
  return map_.rows[map_.regions[region].first_row + row];
}

void Lookups::check(const std::vector<std::string>& lines) {
  std::size_t next = 0;
  for (; next < lines.size(); ++next) {
    Line line(lines[next]);
    if (!line.next("drop")) break;
    readDrop(line);
    line.end();
  }
  for (std::size_t visit = 0; visit < visits_.size(); ++visit) {
    if ((visits_[visit].child & Map::kLeaf) == 0) continue;
    try {
      checkLeaf(visit, lines, next);
    } catch (const Refused& error) {
      throw Refused("leaf " + std::to_string(visits_[visit].child & ~Map::kLeaf) + ": " + error.what());
    }
  }
  require(next == lines.size(), "there are more proofs of look-ups than leaves");
}

/// row = sum of weights times rows on the path and rows of the region + rest, and rest >= constant.
void Lookups::readDrop(Line& line) {
  const std::size_t region = line.count(map_.regions.size() - 1);
  Drop drop;
  drop.visit = line.count(visits_.size() - 1);
  drop.row = line.count(kMany);
  require(drops_[region].empty() || drops_[region].back().visit <= drop.visit,
          "dropped rows are out of order");
  const Integer scale = line.integer();
  require(scale > 0, "a proof has a scale that is not positive");
  Vector rest = mapRow(rowOf(region, drop.row));
  const std::vector<std::int32_t> path = pathTo(drop.visit);
  for (const auto& [place, whole] : readWeights(line)) {
    require(whole >= 0, "a proof has a negative weight");
    Fraction weight(whole, scale);
    weight.canonicalize();
    const bool on_path = place < path.size();
    const Vector row = mapRow(on_path ? path[place] : rowOf(region, place - path.size()));
    for (std::size_t j = 0; j <= map_.p; ++j) rest[j] -= weight * row[j];
    (on_path ? drop.path_weight : drop.row_weight) += weight;
    if (!on_path) drop.rows.emplace_back(place - path.size(), weight);
  }
  drop.constant = leastInWideBox(rest);
  drops_[region].push_back(std::move(drop));
}

/// Dropped rows of a region on the way to the leaf, the last first.
std::vector<const Lookups::Drop*> Lookups::dropsOf(std::size_t region) const {
  std::vector<const Drop*> result;
  const std::vector<Drop>& all = drops_[region];
  for (std::size_t visit = visit_;; visit = visits_[visit].parent) {
    auto at = std::upper_bound(all.begin(), all.end(), visit,
                               [](std::size_t place, const Drop& drop) { return place < drop.visit; });
    while (at != all.begin() && (--at)->visit == visit) result.push_back(&*at);
    if (visit == 0) return result;
  }
}

/// No row of a candidate is violated by more than kReach tolerances where the look-up accepts it.
void Lookups::checkBounds(std::size_t region, std::uint32_t bits) const {
  const std::size_t count = map_.regions[region].row_count;
  const Fraction most = kReach * tolerance_;
  Vector bound(count, most);
  std::vector<char> known(count, 0);
  const auto improve = [&](std::size_t row, const Fraction& value) {
    if (value <= most && (known[row] == 0 || value < bound[row])) {
      known[row] = 1;
      bound[row] = std::max(Fraction(0), value);
    }
  };
  for (std::size_t i = 0; i < count; ++i) {
    const std::int32_t row = rowOf(region, i);
    if (tests(bits, i))
      improve(i, tolerance_ + rounding_);
    else if (contains(path_, row))
      improve(i, rounding_);
    else
      improve(i, -leastInWideBox(mapRow(row)));
  }
  for (const Drop* drop : dropsOf(region)) {
    Fraction value = drop->path_weight * rounding_ - drop->constant;
    bool all_known = true;
    for (const auto& [row, weight] : drop->rows) {
      all_known = all_known && known[row] != 0;
      value += weight * bound[row];
    }
    if (all_known) improve(drop->row, value);
  }
  for (std::size_t i = 0; i < count; ++i)
    require(known[i] != 0, "row " + std::to_string(i) + " of region " + std::to_string(region) +
                               " is not tested, and does not follow from those that are");
}

void Lookups::checkLeaf(std::size_t visit, const std::vector<std::string>& lines, std::size_t& next) {
  visit_ = visit;
  leaf_ = map_.leaves[visits_[visit].child & ~Map::kLeaf];
  path_ = pathTo(visit);
  candidates_.clear();
  known_.clear();
  tests_.clear();
  for (std::size_t k = leaf_.first; k < std::size_t{leaf_.first} + leaf_.count; ++k) {
    candidates_.push_back(map_.candidates[k]);
    require(known_.insert(candidates_.back()).second, "a region is a candidate twice");
    tests_.push_back(map_.tests.empty() ? 0xffffffffu : map_.tests[k]);
    checkBounds(candidates_.back(), tests_.back());
  }
  require(next < lines.size(), "a leaf has no proof");
  Line line(lines[next++]);
  require(line.word() == "leaf", "a leaf has no proof");
  if (line.next("cover")) {
    std::vector<Row> path;
    for (const std::int32_t row : path_) path.push_back(movedRow(row, rounding_));
    std::vector<const Row*> cell;
    for (const Row& row : path) cell.push_back(&row);
    checkCover(line, cell, {tolerance_ - 2 * rounding_, true});
    line.end();
  } else {
    require(line.next("walk"), "a leaf has a proof of another kind");
    checkWalk(line, lines, next);
  }
}

/// The cell is empty, or cut by the rows that are tested in a candidate: what lies outside of each is covered. Or it is
/// cut by a boundary row, moved inwards by the tolerance.
void Lookups::checkCover(Line& line, std::vector<const Row*> cell, const CoverBy& by) const {
  const std::string kind = line.word();
  if (kind == "e") return requireEmpty(line, cell, nullptr);
  if (kind == "b" && by.boundary) {
    const std::size_t region = line.count(map_.regions.size() - 1), facet = line.count(kMany);
    const std::int32_t signed_row = rowOf(region, facet);
    require(regions_[region].facets[facet].is_boundary, "a cut by what is no boundary");
    const Row row = movedRow(signed_row, -tolerance_);
    cell.push_back(&row);
    return checkCover(line, cell, by);
  }
  require(kind == "N", kind + " covers nothing");
  const std::size_t place = line.count(kMany);
  require(place < candidates_.size(), "a part is left to what is no candidate");
  const std::size_t region = candidates_[place];
  std::vector<Row> storage;
  storage.reserve(2 * std::size_t{map_.regions[region].row_count});
  for (std::size_t i = 0; i < map_.regions[region].row_count; ++i) {
    if (!tests(tests_[place], i)) continue;
    storage.push_back(movedRow(rowOf(region, i), by.reach));
    const Row& row = storage.back();
    storage.push_back(row);
    for (Integer& value : storage.back()) value = -value;
    std::vector<const Row*> outside = cell;
    outside.push_back(&storage.back());
    checkCover(line, outside, by);
    cell.push_back(&storage[storage.size() - 2]);
  }
}

void Lookups::checkWalk(Line& line, const std::vector<std::string>& lines, std::size_t& next) {
  checkStart(line);
  line.end();
  path_inside_.clear();
  for (const std::int32_t row : path_) path_inside_.push_back(movedRow(row, -depth_));
  near_.clear();
  beyond_.clear();
  for (; next < lines.size(); ++next) {
    Line proof(lines[next]);
    if (proof.next("outside")) {
      readOutside(proof);
    } else if (proof.next("near")) {
      readNear(proof);
    } else if (proof.next("beyond")) {
      readBeyond(proof);
    } else if (proof.next("sliver")) {
      readSliver(proof);
    } else {
      break;
    }
    proof.end();
  }
  for (const std::size_t region : candidates_) checkBehind(region, true);
  for (const std::size_t region : near_) checkBehind(region, false);
}

/// A point inside of a candidate, so deep in the leaf that what arrives there can be moved towards it.
void Lookups::checkStart(Line& line) {
  const std::size_t place = line.count(kMany);
  require(place < candidates_.size(), "a walk starts in what is no candidate");
  depth_ = power(-static_cast<int>(line.count(1000)));
  Vector point;
  while (!line.done()) point.push_back(line.fraction());
  require(point.size() == map_.p, "the starting point is missing");
  for (const Fraction& value : point) require(abs(value) < 1, "the starting point lies outside of the box");
  require(regions_[candidates_[place]].is_exact, "a walk starts where conditions hold up to rounding only");
  for (const Row& row : conditions_(candidates_[place]))
    require(valueAt(row, point) > 0, "the starting point does not lie inside");
  const auto at_point = [&](std::int32_t row) {
    const Vector values = mapRow(row);
    Fraction value = values.back();
    for (std::size_t j = 0; j < map_.p; ++j) value += values[j] * point[j];
    return value;
  };
  Fraction deep(1), greatest, error;
  for (const std::int32_t row : path_) deep = std::min(deep, at_point(row));
  for (std::size_t k = 0; k < candidates_.size(); ++k) {
    const std::size_t region = candidates_[k];
    error = std::max(error, regions_[region].plane_error);
    for (std::size_t i = 0; i < map_.regions[region].row_count; ++i) {
      if (tests(tests_[k], i)) greatest = std::max(greatest, Fraction(abs(at_point(rowOf(region, i)))));
    }
  }
  const Fraction room = tolerance_ - 2 * rounding_ - plane_tolerance_ - error;
  require(deep > 0 && (depth_ + rounding_) * (greatest + tolerance_) <= room * (deep + rounding_),
          "the starting point is not deep enough");
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

void Lookups::readBeyond(Line& line) {
  const std::size_t region = line.count(map_.regions.size() - 1);
  const std::vector<Row> rows = moved_rows_(region);
  requireEmpty(line, cellWith(rows), nullptr);
  beyond_.insert(region);
}

/// Of the regions that cover a sliver, moved outwards, only candidates reach into the leaf.
void Lookups::readSliver(Line& line) {
  const std::size_t sliver = line.count(regions_.size() - 1);
  require(sliver >= map_.regions.size(), "a region of the map is no sliver");
  for (const std::size_t region : regions_[sliver].covered_by)
    require(contains(candidates_, region) || beyond_.count(region) > 0,
            "a sliver reaches into a region that is no candidate");
  known_.insert(sliver);
  near_.push_back(sliver);
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
  if (contains(path_, rowOf(region, facet))) return depth_ >= error;
  if (moved_) return false;
  const std::vector<const Drop*> drops = dropsOf(region);
  return std::any_of(drops.begin(), drops.end(), [&](const Drop* drop) {
    return drop->row == facet &&
           drop->constant + depth_ * drop->path_weight >= error * (1 + drop->row_weight);
  });
}

}  // namespace checker
