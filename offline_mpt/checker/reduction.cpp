#include "reduction.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "checksum.hpp"

namespace checker {
namespace {

constexpr int kDeepest = 2000;  // nested cuts, which bounds the stack

/// The two maps are of one problem, and belong together.
void requirePair(const Map& reduced, const Map& original) {
  require(reduced.reduced_from != 0, "the map was not reduced from another one");
  require(original.reduced_from == 0, "the original was itself reduced from another map");
  require(reduced.reduced_from == original.checksum, "the map was reduced from another original");
  require(reduced.p == original.p && reduced.q == original.q && reduced.bounds == original.bounds,
          "the box is not the original's");
  require(reduced.tolerance == original.tolerance && reduced.period == original.period,
          "tolerance or period are not the original's");
  for (std::size_t k = 1; k < reduced.words.size(); ++k) {  // 0: name, 4: notes
    require(k == 4 || reduced.words[k] == original.words[k],
            "problem, status or signals are not the original's");
  }
}

Fraction slackOf(const std::string& text) {
  std::istringstream lines(text);
  std::string line;
  while (std::getline(lines, line)) {
    if (line.compare(0, 11, "tolerances ") != 0) continue;
    Line words(line.substr(11));
    words.real();
    return words.real();
  }
  throw Refused("tolerances are missing");
}

}  // namespace

MapRows::MapRows(const Map& map, const Fraction& slack) : map_(map), scaling_(map), slack_(slack) {}

const Row& MapRows::at(std::int32_t row, Moved moved, bool outside) const {
  const auto key = std::make_pair(row, 2 * static_cast<int>(moved) + (outside ? 1 : 0));
  const auto known = known_.find(key);
  if (known != known_.end()) return known->second;
  Vector value = scaling_.mapRow(map_, row);
  if (moved == Moved::kSlack) value.back() += slack_;
  if (outside) {
    for (Fraction& entry : value) entry = -entry;
  }
  return known_.emplace(key, primitive(value)).first->second;
}

Reduction::Reduction(const std::string& text, const Map& reduced, const Map& original)
    : reduced_map_(reduced),
      original_map_(original),
      slack_(slackOf(text)),
      reduced_(reduced, slack_),
      original_(original, slack_) {
  requirePair(reduced, original);
  if (!reduced.tests.empty()) answers_.emplace(reduced);
  std::istringstream lines(unsealed(text));
  std::string line;
  require(std::getline(lines, line) && line == "polyfly reduction certificate 1",
          "not a certificate of a reduction of version 1");
  while (std::getline(lines, line)) {
    Line words(line);
    readHead(words);
  }
  require(originals_.size() == original.regions.size() && claims_.size() == reduced.regions.size(),
          "regions are missing");
  require(slack_ >= 0 && 2 * slack_ <= Fraction(reduced.tolerance), "the slack is above half the tolerance");
  require(law_tolerance_ >= 0 && law_tolerance_ <= Fraction(kMostLawTolerance),
          "the law tolerance is out of range");
  require(head_.size() == 3, "a line of the head is missing");
}

void Reduction::readHead(Line& line) {
  const std::string key = line.word();
  if (key != "O" && key != "R" && key != "drop") require(head_.insert(key).second, key + " is given twice");
  if (key == "reduced" || key == "original") {
    const Map& map = key == "reduced" ? reduced_map_ : original_map_;
    require(line.word() == hexText(map.checksum) && line.count(SIZE_MAX) == map.size,
            "the certificate is of another map");
  } else if (key == "tolerances") {
    law_tolerance_ = line.real();
    line.real();
  } else if (key == "drop" && answers_) {
    answers_->readDrop(line);
  } else {
    require(key == "O" || key == "R", key + " is no item of this certificate");
    std::vector<std::string>& proofs = key == "O" ? originals_ : claims_;
    require(line.count(kMany) == proofs.size(), "regions are out of order");
    proofs.push_back(line.rest());
  }
  line.end();
}

std::string Reduction::conditions() const {
  char line[200];
  std::snprintf(
      line, sizeof line,
      "every answer is one of the original's, within %g of each half-space (scaled); laws differ by at "
      "most %g (relative)\n",
      slack_.get_d(), law_tolerance_.get_d());
  return line;
}

/// Greatest finite |bound| of an input. Without one, the greatest |u| of a law of the original in the box, at most 1.
Fraction Reduction::scaleOf(std::size_t input) const {
  const std::size_t p = original_map_.p, q = original_map_.q;
  Fraction scale;
  for (const double bound :
       {original_map_.bounds[2 * (p + input)], original_map_.bounds[2 * (p + input) + 1]}) {
    if (std::isfinite(bound)) scale = std::max(scale, Fraction(std::abs(bound)));
  }
  if (scale > 0) return scale;
  for (std::size_t at = input * (p + 1); at < original_map_.laws.size(); at += q * (p + 1)) {
    const Fraction greatest = reduced_.scaling().greatestInBox(original_map_.laws.data() + at);
    scale = std::max(scale, std::min(Fraction(1), greatest));
  }
  return scale > 0 ? scale : Fraction(1);
}

/// Laws differ by little all over the box.
bool Reduction::sameLaw(std::uint32_t reduced, std::uint32_t original) const {
  const auto known = same_.find({reduced, original});
  if (known != same_.end()) return known->second;
  const std::size_t p = reduced_map_.p, q = reduced_map_.q;
  const Scaling& scaling = reduced_.scaling();
  bool same = true;
  for (std::size_t i = 0; i < q && same; ++i) {
    const double* a = reduced_map_.laws.data() + (reduced * q + i) * (p + 1);
    const double* b = original_map_.laws.data() + (original * q + i) * (p + 1);
    if (scales_.size() <= i) scales_.push_back(scaleOf(i));
    const Vector u = scaling.inBox(a, 1, Fraction(a[p])), v = scaling.inBox(b, 1, Fraction(b[p]));
    Fraction difference;
    for (std::size_t j = 0; j <= p; ++j) difference += abs(u[j] - v[j]);
    same = difference <= law_tolerance_ * scales_[i];
  }
  same_.emplace(std::make_pair(reduced, original), same);
  return same;
}

/// Rows that hold everywhere are left out.
Reduction::Cell Reduction::cellOf(const MapRows& rows, std::size_t region) const {
  const Map::Region& source = rows.map().regions[region];
  Cell cell;
  for (std::size_t k = 0; k < source.row_count; ++k) {
    const Row& row = rows.at(rows.map().rows[source.first_row + k], MapRows::Moved::kNot, false);
    const bool is_constant =
        std::all_of(row.begin(), row.end() - 1, [](const Integer& value) { return value == 0; });
    if (!is_constant || row.back() < 0) cell.push_back(&row);
  }
  return cell;
}

/// Each side of a plane is empty, or `visit` shows what becomes of it; or one that is the whole cell.
template <class Visit>
void Reduction::checkSides(Line& line, const MapRows& rows, std::uint32_t plane, const Cell& cell,
                           Visit&& visit) const {
  for (const bool below : {true, false}) {
    const auto row = static_cast<std::int32_t>(plane) + 1;
    Cell side = cell;
    const std::string what = line.word();
    if (what != "w") side.push_back(&rows.at(below ? row : -row, MapRows::Moved::kNot, false));
    if (what == "e") {
      requireEmpty(line, side, nullptr);
    } else {
      require(what == "s" || what == "w", what + " is no side of a plane");
      visit(below, side);
    }
  }
}

/// What arrives at the leaves of the reduced map's tree is covered there.
void Reduction::walk(Line& line, std::uint32_t child, const Cell& cell, Scope scope, int depth) const {
  require(depth < kDeepest, "cuts are nested too deeply");
  if ((child & Map::kLeaf) != 0) {
    scope.leaf = &reduced_map_.leaves[child & ~Map::kLeaf];
    return cover(line, cell, scope, depth + 1);
  }
  const Map::Node& node = reduced_map_.nodes[child];
  require(line.word() == "n" && line.count(kMany) == node.plane, "the way through the tree is another one");
  checkSides(line, reduced_, node.plane, cell, [&](bool below, const Cell& side) {
    walk(line, below ? node.below : node.above, side, scope, depth + 1);
  });
}

void Reduction::cover(Line& line, Cell cell, const Scope& scope, int depth) const {
  require(depth < kDeepest, "cuts are nested too deeply");
  const std::string kind = line.word();
  if (kind == "e") return requireEmpty(line, cell, nullptr);
  if (kind == "B") return coverByBoth(line, cell, scope, depth);
  if (kind != "n") return cutByRegion(line, kind, std::move(cell), scope, depth);
  const std::size_t plane = line.count(original_map_.planes.size() / (original_map_.p + 1) - 1);
  checkSides(line, original_, static_cast<std::uint32_t>(plane), cell,
             [&](bool, const Cell& side) { cover(line, side, scope, depth + 1); });
}

bool Reduction::isCandidate(std::uint32_t region, const Scope& scope) const {
  if (scope.leaf == nullptr) return false;
  const auto first = reduced_map_.candidates.begin() + scope.leaf->first;
  return std::find(first, first + scope.leaf->count, region) != first + scope.leaf->count;
}

/// A sliver of the original that a candidate with another law holds: so do regions of the original with that
/// law.
void Reduction::coverByBoth(Line& line, const Cell& cell, const Scope& scope, int depth) const {
  const auto candidate = static_cast<std::uint32_t>(line.count(reduced_map_.regions.size() - 1));
  require(!scope.is_claim && isCandidate(candidate, scope), "a sliver is left to what is no candidate");
  Scope inner = scope;
  inner.candidate = candidate;
  inner.owners = false;
  cover(line, cell, inner, depth + 1);
  inner.owners = true;
  cover(line, cell, inner, depth + 1);
}

void Reduction::requireAllowed(const std::string& kind, std::uint32_t region, const Scope& scope) const {
  if (kind == "C") {
    const bool is_right = scope.candidate >= 0 ? !scope.owners && region == scope.candidate
                                               : !scope.is_claim && isCandidate(region, scope) &&
                                                     sameLaw(reduced_map_.regions[region].law, scope.law);
    require(is_right, "a part is answered by a region that does not answer it, or with another law");
  } else {
    require(kind == "N", kind + " covers nothing");
    const std::uint32_t law = original_map_.regions[region].law;
    const bool is_right = scope.is_claim
                              ? sameLaw(scope.law, law)
                              : scope.owners && sameLaw(reduced_map_.regions[scope.candidate].law, law);
    require(is_right, "a part is claimed by a region with another law");
  }
}

/// What lies outside of each half-space of a region is covered; what remains lies in the region.
void Reduction::cutByRegion(Line& line, const std::string& kind, Cell cell, const Scope& scope,
                            int depth) const {
  const MapRows& rows = kind == "N" ? original_ : reduced_;
  const auto region = static_cast<std::uint32_t>(line.count(rows.map().regions.size() - 1));
  requireAllowed(kind, region, scope);
  const Map::Region& source = rows.map().regions[region];
  for (std::size_t k = 0; k < source.row_count; ++k) {
    const std::int32_t row = rows.map().rows[source.first_row + k];
    const std::string what = line.word();
    Cell outside = cell;
    outside.push_back(&rows.at(row, MapRows::Moved::kSlack, true));
    if (what == "e") {
      requireEmpty(line, outside, nullptr);
      continue;
    }
    require(what == "s", what + " covers nothing");
    cover(line, std::move(outside), scope, depth + 1);
    cell.push_back(&rows.at(row, MapRows::Moved::kSlack, false));
    if (line.next("q")) return requireEmpty(line, cell, nullptr);
  }
}

void Reduction::checkOriginal(std::size_t region) const {
  Line line(originals_[region]);
  Scope scope;
  scope.law = original_map_.regions[region].law;
  const Cell cell = cellOf(original_, region);
  if (line.next("e")) {
    requireEmpty(line, cell, nullptr);
  } else {
    walk(line, reduced_map_.root, cell, scope, 0);
  }
  line.end();
}

void Reduction::checkReduced(std::size_t region) const {
  Line line(claims_[region]);
  Scope scope;
  scope.is_claim = true;
  scope.law = reduced_map_.regions[region].law;
  const Cell cell = cellOf(reduced_, region);
  if (line.next("e")) {
    requireEmpty(line, cell, nullptr);
  } else {
    cover(line, cell, scope, 0);
  }
  line.end();
}

void Reduction::check() {
  const auto check_all = [&](std::size_t count, const char* of, auto&& check_one) {
    for (std::size_t region = 0; region < count; ++region) {
      try {
        check_one(region);
      } catch (const Refused& error) {
        throw Refused("region " + std::to_string(region) + " of the " + of + ": " + error.what());
      }
    }
  };
  if (answers_) answers_->checkLeaves([](const char*, std::size_t, std::size_t) {}, [] {});
  check_all(originals_.size(), "original", [&](std::size_t region) { checkOriginal(region); });
  check_all(claims_.size(), "reduced map", [&](std::size_t region) { checkReduced(region); });
}

}  // namespace checker
