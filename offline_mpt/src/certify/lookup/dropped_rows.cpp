#include "certify/lookup/dropped_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "arithmetic/exact_numbers.hpp"
#include "certify/multipliers.hpp"
#include "certify/tolerances.hpp"
#include "lp/float_lp.hpp"

namespace polyfly {
namespace {

// Weights are short where the constant has room for their rounding.
constexpr int kShortBits = 30, kLongBits = 52;
// Tolerances of a look-up by which a row that is dropped at a node may be violated where the others are by one, and the
// same at a leaf.
constexpr double kNodeReach = 3.0, kLeafReach = 1.0 * kReach;

double below(const Rational& value) { return -above(-value); }

// FloatLp has the box |t_j| <= 1, look-ups have a wider one. So t is divided by this for it.
constexpr double kWideBox = 1.0 + 1.0 / (1 << WholePlanes::kWideBits);

/// scale * row = sum of weight * row + rest. Places: rows on a path, then rows of the region.
struct RowCombination {
  Integer scale = 1;
  std::vector<std::pair<std::size_t, Integer>> weights;
};

RowCombination rounded(const std::vector<std::pair<std::size_t, double>>& weights, int bits) {
  RowCombination result;
  result.scale <<= static_cast<unsigned long>(bits);
  for (const auto& [place, weight] : weights) {
    const Integer whole = toInteger(weight, bits);
    if (whole > 0) result.weights.emplace_back(place, whole);
  }
  return result;
}

class Dropper {
 public:
  Dropper(const RegionMap& map, const WholePlanes& planes, const LookupTree& tree, std::uint32_t region)
      : planes_(planes),
        tree_(tree),
        region_(region),
        view_(map.region(region)),
        tolerance_(map.tolerance()),
        solver_(planes.parameters()) {
    for (std::uint32_t i = 0; i < view_.row_count; ++i)
      add(view_.rows[i], planes.tolerance(), own_, own_units_);
  }

  RegionDrops drop() {
    descend(0, std::vector<char>(view_.row_count, 1), true);
    return std::move(drops_);
  }

 private:
  void add(std::int32_t row, const Integer& moved_by, std::vector<WholeRow>& rows,
           std::vector<std::vector<double>>& units) const {
    rows.push_back(planes_.row(row));
    units.push_back(planes_.moved(row, moved_by).unit);
    units.back().back() /= kWideBox;
  }

  /// `live`: rows that are not dropped; `is_new`: the part of the region differs from that at the parent.
  void descend(std::size_t visit, std::vector<char> live, bool is_new) {
    const TreeMember& member = *tree_.member(visit, region_);
    const bool is_leaf = tree_.isLeaf(visit);
    if (is_new || is_leaf || (!path_.empty() && isOwn(path_.back()))) dropAt(visit, member.tests, live);
    if (is_leaf) return boundAt(visit, member.tests);
    const bool below = tree_.member(tree_.below(visit), region_) != nullptr;
    const bool above = tree_.member(tree_.above(visit), region_) != nullptr;
    for (const std::size_t child : {tree_.below(visit), tree_.above(visit)}) {
      if (!(child == tree_.below(visit) ? below : above)) continue;
      path_.push_back(tree_.row(child));
      add(path_.back(), planes_.rounding(), path_rows_, path_units_);
      descend(child, live, below && above);
      path_.pop_back();
      path_rows_.pop_back();
      path_units_.pop_back();
    }
  }

  /// Bounds of all rows at a leaf. Each follows from rows that are tested, or that were dropped later.
  std::vector<double> bounds(std::size_t leaf, std::uint32_t tests) const {
    const double rounding = above(planes_.length(planes_.rounding()));
    std::vector<double> result(view_.row_count, std::numeric_limits<double>::infinity());
    for (std::uint32_t i = 0; i < view_.row_count; ++i) {
      if (isTested(tests, i)) result[i] = (tolerance_ + rounding) * tolerance::kRoundUp;
    }
    for (std::size_t visit = leaf;; visit = tree_.parent(visit)) {
      const RegionDrops::Range here = drops_.at(visit);
      for (const DroppedRow* dropped = here.last; dropped != here.first;) {
        --dropped;
        double sum = dropped->most_path_weight * rounding - dropped->constant;
        for (const auto& [row, weight] : dropped->rows) sum += weight * result[row];
        result[dropped->row] = std::min(result[dropped->row], std::max(0.0, sum * tolerance::kRoundUp));
      }
      if (visit == 0) return result;
    }
  }

  /// Rows that reach too far by way of others are dropped again, by way of the tested ones alone.
  void boundAt(std::size_t leaf, std::uint32_t tests) {
    const double most = kReach * tolerance_;
    std::vector<char> tested(view_.row_count, 0);
    for (std::uint32_t i = 0; i < view_.row_count; ++i) tested[i] = isTested(tests, i) ? 1 : 0;
    const std::vector<double> first = bounds(leaf, tests);
    for (std::uint32_t i = 0; i < view_.row_count; ++i) {
      if (!(first[i] <= most)) dropRow(leaf, i, tested, most);
    }
    const std::vector<double> second = bounds(leaf, tests);
    for (std::uint32_t i = 0; i < view_.row_count; ++i) {
      if (!(second[i] <= most)) drops_.unbounded.push_back({leaf, i, second[i]});
    }
  }

  bool isOwn(std::int32_t row) const {
    return std::find(view_.rows, view_.rows + view_.row_count, row) != view_.rows + view_.row_count;
  }

  void dropAt(std::size_t visit, std::uint32_t tests, std::vector<char>& live) {
    const double reach = (tree_.isLeaf(visit) ? kLeafReach : kNodeReach) * tolerance_;
    for (std::uint32_t i = 0; i < view_.row_count; ++i) {
      if (live[i] == 0 || isTested(tests, i)) continue;
      live[i] = 0;
      if (!dropRow(visit, i, live, reach)) live[i] = 1;
    }
  }

  bool dropRow(std::size_t visit, std::uint32_t i, const std::vector<char>& live, double reach) {
    const auto on_path = std::find(path_.begin(), path_.end(), view_.rows[i]);
    if (on_path != path_.end()) {
      RowCombination itself;
      itself.weights.emplace_back(on_path - path_.begin(), 1);
      drops_.rows.push_back(describe(visit, i, itself, 0));
      return true;
    }
    RowCombination combination;
    Rational constant = restOf(i, combination);
    if (constant < -2 * Rational(tolerance_)) {
      if (!combine(i, live, reach, combination)) return false;
      constant = restOf(i, combination);
    }
    DroppedRow dropped = describe(visit, i, combination, constant);
    if (dropped.constant < -reach) return false;
    if (!combination.weights.empty()) appendLine(visit, i, combination);
    drops_.rows.push_back(std::move(dropped));
    return true;
  }

  bool combine(std::uint32_t target, const std::vector<char>& live, double reach, RowCombination& result) {
    std::vector<std::pair<std::size_t, double>> weights;
    const FloatLp::Status status = findWeights(target, live, weights);
    const double far = solver_.objective() - own_units_[target].back() + tolerance_;
    if (status == FloatLp::Status::kOptimal && far > reach) return false;
    const bool is_leaf = reach >= kLeafReach * tolerance_;
    const Rational allowed(is_leaf ? std::max(tolerance_, reach - weightOfOwn(weights) * tolerance_)
                                   : tolerance_);
    for (const int bits : {kShortBits, kLongBits}) {
      result = rounded(weights, bits);
      const Rational constant = restOf(target, result);
      if (constant >= 0 || (bits == kLongBits && constant >= -allowed)) return true;
    }
    return is_leaf && findExactly(target, live, reach, result);
  }

  double weightOfOwn(const std::vector<std::pair<std::size_t, double>>& weights) const {
    double sum = 0.0;
    for (const auto& [place, weight] : weights) sum += place < path_.size() ? 0.0 : weight;
    return sum;
  }

  FloatLp::Status findWeights(std::uint32_t target, const std::vector<char>& live,
                              std::vector<std::pair<std::size_t, double>>& weights) {
    solver_.clear();
    std::vector<std::size_t> places;
    for (std::size_t k = 0; k < path_.size() + view_.row_count; ++k) {
      if (k >= path_.size() && live[k - path_.size()] == 0) continue;
      solver_.add(unitAt(k));
      places.push_back(k);
    }
    const std::vector<double>& unit = own_units_[target];
    const FloatLp::Status status = solver_.maximise({unit.begin(), unit.end() - 1});
    if (status == FloatLp::Status::kFailed) return status;
    double sum = 0.0;  // of bounds: negative where the rows exclude each other
    for (const auto& [k, weight] : solver_.weights()) {
      const auto row = static_cast<std::size_t>(k);
      sum += weight * (row < places.size() ? unitAt(places[row]).back() : 1.0);
    }
    const double factor = status == FloatLp::Status::kInfeasible ? -tolerance::kFarAway / sum : 1.0;
    for (const auto& [k, weight] : solver_.weights()) {
      const auto row = static_cast<std::size_t>(k);
      if (row < places.size() && weight > 0.0 && std::isfinite(weight * factor))
        weights.emplace_back(places[row], weight * factor);
    }
    return status;
  }

  const std::vector<double>& unitAt(std::size_t place) const {
    return place < path_.size() ? path_units_[place] : own_units_[place - path_.size()];
  }

  /// Weights without rounding, where planes meet at so sharp an angle that rounded ones prove nothing.
  bool findExactly(std::uint32_t target, const std::vector<char>& live, double reach,
                   RowCombination& result) {
    std::vector<ExactRow> moved;
    std::vector<Integer> factors;  // that were divided out of the rows
    std::vector<std::size_t> places;
    const auto add_moved = [&](std::size_t place, const WholeRow& whole, std::int32_t row,
                               const Integer& by) {
      places.push_back(place);
      moved.push_back(planes_.moved(row, by));
      const auto k =
          std::find_if(whole.begin(), whole.end() - 1, [](const Integer& value) { return value != 0; });
      const Integer& kept = moved.back().value[static_cast<std::size_t>(k - whole.begin())];
      factors.push_back(kept != 0 ? Integer(*k / kept) : Integer(1));
    };
    for (std::size_t k = 0; k < path_.size(); ++k) add_moved(k, path_rows_[k], path_[k], planes_.rounding());
    for (std::uint32_t k = 0; k < view_.row_count; ++k) {
      if (live[k] != 0) add_moved(path_.size() + k, own_[k], view_.rows[k], planes_.tolerance());
    }
    add_moved(0, own_[target], view_.rows[target], planes_.up(Rational(reach)));
    ExactRows rows;
    for (std::size_t k = 0; k + 1 < moved.size(); ++k) rows.push_back(&moved[k]);
    const Implication found = implies(rows, moved.back(), solver_);
    if (!found.holds) return false;
    const std::size_t bits = mostBits(rows, &moved.back());
    Integer common(1);
    for (const auto& weight : found.proof.weights) common *= factors[static_cast<std::size_t>(weight.first)];
    result.scale = found.proof.scale * (common << (bits - moved.back().bits));
    result.weights.clear();
    Integer divisor = result.scale;
    for (const auto& [row, weight] : found.proof.weights) {
      const auto k = static_cast<std::size_t>(row);
      result.weights.emplace_back(
          places[k], weight * ((common / factors[k] * factors.back()) << (bits - moved[k].bits)));
      divisor = gcd(divisor, result.weights.back().second);
    }
    result.scale /= divisor;
    for (auto& [place, weight] : result.weights) weight /= divisor;
    return true;
  }

  /// Least value of the rest, divided by the scale.
  Rational restOf(std::uint32_t target, const RowCombination& combination) const {
    WholeRow rest = own_[target];
    for (Integer& value : rest) value *= combination.scale;
    for (const auto& [place, weight] : combination.weights) {
      const WholeRow& other = place < path_.size() ? path_rows_[place] : own_[place - path_.size()];
      for (std::size_t j = 0; j < rest.size(); ++j)
        mpz_submul(rest[j].get_mpz_t(), weight.get_mpz_t(), other[j].get_mpz_t());
    }
    Rational result = planes_.length(planes_.leastInWideBox(rest)) / combination.scale;
    mpq_div_2exp(result.get_mpq_t(), result.get_mpq_t(), WholePlanes::kWideBits);
    return result;
  }

  DroppedRow describe(std::size_t visit, std::uint32_t row, const RowCombination& combination,
                      const Rational& constant) const {
    DroppedRow dropped;
    dropped.visit = visit;
    dropped.row = row;
    Rational path, others;
    for (const auto& [place, weight] : combination.weights) {
      Rational share(weight, combination.scale);
      share.canonicalize();
      if (place < path_.size()) {
        path += share;
      } else {
        others += share;
        dropped.rows.emplace_back(static_cast<std::uint32_t>(place - path_.size()), above(share));
      }
    }
    dropped.constant = below(constant);
    dropped.least_path_weight = below(path);
    dropped.most_path_weight = above(path);
    dropped.row_weight = above(others);
    return dropped;
  }

  void appendLine(std::size_t visit, std::uint32_t row, const RowCombination& combination) {
    drops_.text += "drop " + std::to_string(region_) + " " + std::to_string(visit) + " " +
                   std::to_string(row) + " " + combination.scale.get_str(16) + " " +
                   std::to_string(combination.weights.size());
    for (const auto& [place, weight] : combination.weights)
      drops_.text += " " + std::to_string(place) + " " + weight.get_str(16);
    drops_.text += "\n";
  }

  const WholePlanes& planes_;
  const LookupTree& tree_;
  std::uint32_t region_;
  RegionView view_;
  double tolerance_;
  FloatLp solver_;
  /// Rows of the region, and those on the path; in floating point moved outwards by what look-ups allow.
  std::vector<WholeRow> own_, path_rows_;
  std::vector<std::vector<double>> own_units_, path_units_;
  std::vector<std::int32_t> path_;
  RegionDrops drops_;
};

}  // namespace

bool DroppedRow::holdsInside(double depth, double error) const {
  const double gain = depth * least_path_weight * tolerance::kRoundDown;
  const double loss =
      error * (1.0 + row_weight) / tolerance::kRoundDown - std::min(constant, 0.0) / tolerance::kRoundDown;
  return std::max(constant, 0.0) * tolerance::kRoundDown + gain >= loss / tolerance::kRoundDown;
}

RegionDrops::Range RegionDrops::at(std::size_t visit) const {
  const auto first =
      std::lower_bound(rows.begin(), rows.end(), visit,
                       [](const DroppedRow& dropped, std::size_t place) { return dropped.visit < place; });
  auto last = first;
  while (last != rows.end() && last->visit == visit) ++last;
  return {rows.data() + (first - rows.begin()), rows.data() + (last - rows.begin())};
}

RegionDrops dropRows(const RegionMap& map, const WholePlanes& planes, const LookupTree& tree,
                     std::uint32_t region) {
  if (tree.member(0, region) == nullptr) return {};
  return Dropper(map, planes, tree, region).drop();
}

}  // namespace polyfly
