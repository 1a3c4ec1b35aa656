// Statement 6, first half: no answer violates a half-space of its region by more than 8 tolerances.
#include <algorithm>

#include "core/lookups.hpp"

namespace checker {
namespace {

constexpr int kWideBits = 26;  // look-ups accept no more than |t_j| <= 1 + 2^-26

}  // namespace

LookupAnswers::LookupAnswers(const Map& map)
    : map_(map), tolerance_(map.tolerance), scaling_(map), drops_(map.regions.size()) {
  require(tolerance_ > 0, "the map's tolerance is out of range");
  findRounding();
  walkTree();
}

/// The test of the box lets |t_j| <= 1 + tolerance pass, and what the rounding of its bounds adds.
void LookupAnswers::findRounding() {
  for (std::size_t j = 0; j < map_.p; ++j) {
    const Fraction size = abs(scaling_.centre[j]) + scaling_.half[j];
    require(size * powerOfTwo(-50) <= (powerOfTwo(-kWideBits) - tolerance_) * scaling_.half[j],
            "the range of a parameter is too narrow for the size of its numbers");
  }
  Fraction greatest;
  for (std::size_t k = 0; k < map_.planes.size(); k += map_.p + 1)
    greatest = std::max(greatest, scaling_.roundingOf(map_.planes.data() + k, 1 + powerOfTwo(-kWideBits)));
  rounding_ = roundedUp(greatest);
  require(4 * rounding_ <= tolerance_, "distances from planes are not computed precisely enough");
}

void LookupAnswers::walkTree() {
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

std::vector<std::int32_t> LookupAnswers::pathTo(std::size_t visit) const {
  std::vector<std::int32_t> path;
  for (; visit != 0; visit = visits_[visit].parent) path.push_back(visits_[visit].row);
  std::reverse(path.begin(), path.end());
  return path;
}

Row LookupAnswers::movedRow(std::int32_t row, const Fraction& outwards) const {
  Vector values = mapRow(row);
  values.back() += outwards;
  return primitive(values);
}

Fraction LookupAnswers::leastInWideBox(const Vector& row) const {
  Fraction sides;
  for (std::size_t j = 0; j < map_.p; ++j) sides += abs(row[j]);
  return row.back() - sides * (1 + powerOfTwo(-kWideBits));
}

std::int32_t LookupAnswers::rowOf(std::size_t region, std::size_t row) const {
  require(row < map_.regions[region].row_count, "a proof names a row that is not there");
  return map_.rows[map_.regions[region].first_row + row];
}

void LookupAnswers::checkLeaves(const Progress& progress, const std::function<void()>& visit) {
  for (std::size_t i = 0; i < visits_.size(); ++i) {
    progress("node", i, visits_.size());
    if ((visits_[i].child & Map::kLeaf) == 0) continue;
    try {
      readCandidates(i);
      visit();
    } catch (const Refused& error) {
      throw Refused("leaf " + std::to_string(visits_[i].child & ~Map::kLeaf) + ": " + error.what());
    }
  }
}

/// row = sum of weights times rows on the path and rows of the region + rest, and rest >= constant.
void LookupAnswers::readDrop(Line& line) {
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
std::vector<const LookupAnswers::Drop*> LookupAnswers::dropsOf(std::size_t region) const {
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
void LookupAnswers::checkBounds(std::size_t region, std::uint32_t bits) const {
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
    if (isTested(bits, i))
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

/// Reads the leaf that a visit leads to, and shows that its answers are right.
void LookupAnswers::readCandidates(std::size_t visit) {
  visit_ = visit;
  path_ = pathTo(visit);
  candidates_.clear();
  tests_.clear();
  const Map::Leaf& leaf = map_.leaves[visits_[visit].child & ~Map::kLeaf];
  for (std::size_t k = leaf.first; k < std::size_t{leaf.first} + leaf.count; ++k) {
    require(!contains(candidates_, map_.candidates[k]), "a region is a candidate twice");
    candidates_.push_back(map_.candidates[k]);
    tests_.push_back(map_.tests.empty() ? 0xffffffffu : map_.tests[k]);
    checkBounds(candidates_.back(), tests_.back());
  }
}

}  // namespace checker
