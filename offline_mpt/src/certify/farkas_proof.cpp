#include "certify/farkas_proof.hpp"

#include <algorithm>
#include <cmath>

#include "certify/multipliers.hpp"
#include "certify/tolerances.hpp"
#include "lp/box_maximum.hpp"

namespace polyfly {
namespace {

// Bits of the weights in a first try. Short weights keep the certificate small.
constexpr int kShortBits = 24;
constexpr int kLongBits = 60;

using Rows = ExactRows;

bool nearlySame(const ExactRow& a, const ExactRow& b) {
  for (std::size_t j = 0; j < a.unit.size(); ++j) {
    if (!(std::abs(a.unit[j] - b.unit[j]) <= tolerance::kNearPlanes * (1.0 + std::abs(a.unit[j]))))
      return false;
  }
  return true;
}

/// The proof from one row that is a multiple of the target.
bool proveByMultiple(const Rows& rows, const ExactRow& target, FarkasProof& proof) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const ExactRow& row = *rows[i];
    if (!nearlySame(row, target) || !sameHalfSpace(target, row)) continue;
    std::size_t k = 0;
    while (row.value[k] == 0) ++k;
    const std::size_t bits = std::max(row.bits, target.bits);
    Integer numerator = abs(target.value[k]) << static_cast<unsigned long>(bits - target.bits);
    Integer denominator = abs(row.value[k]) << static_cast<unsigned long>(bits - row.bits);
    const Integer divisor = gcd(numerator, denominator);
    proof = {denominator / divisor, {{static_cast<int>(i), numerator / divisor}}};
    return true;
  }
  return false;
}

/// A proof with exact weights for the rows that the guess found to matter.
bool proveByBasis(const FloatLp& solver, const Rows& rows, const ExactRow& target, FarkasProof& proof) {
  std::vector<char> skip(target.value.size() - 1, 0);
  std::vector<int> places;
  const Rows chosen = rowsOfWeights(solver.weights(), rows, solver.boxIndex(0), skip, places);
  std::vector<Rational> exact;
  if (chosen.empty() || !combineExactly(chosen, target, skip, exact)) return false;
  std::vector<std::pair<int, Rational>> weights;
  for (std::size_t k = 0; k < exact.size(); ++k) weights.emplace_back(places[k], exact[k]);
  proof = clearFractions(std::move(weights), rows, mostBits(rows, &target), target.bits);
  return proves(proof, rows, target);
}

/// The same for a cell without interior. Rows of the guess: the given ones, `on` and its opposite, sides.
bool emptyByBasis(const FloatLp& solver, const Rows& rows, const ExactRow* on, int p, FarkasProof& proof) {
  const int count = static_cast<int>(rows.size());
  std::vector<char> skip(static_cast<std::size_t>(p), 0);
  std::vector<int> places;
  Rows chosen = rowsOfWeights(solver.weights(), rows, count + (on != nullptr ? 2 : 0), skip, places);
  if (chosen.empty()) return false;
  const ExactRow& target = *chosen.front();
  const int target_place = places.front();
  chosen.erase(chosen.begin());
  places.erase(places.begin());
  if (on != nullptr) {
    chosen.push_back(on);
    places.push_back(count);
  }
  std::vector<Rational> exact;
  if (!combineExactly(chosen, target, skip, exact)) return false;
  std::vector<std::pair<int, Rational>> weights{{target_place, Rational(1)}};
  for (std::size_t k = 0; k < exact.size(); ++k) {
    if (exact[k] != 0) weights.emplace_back(places[k], -exact[k]);
  }
  proof = clearFractions(std::move(weights), rows, mostBits(rows, on), on != nullptr ? on->bits : 0);
  return provesEmpty(proof, rows, on);
}

/// Least value of the target where the rows are >= 0, without rounding, first at the basis of the guess.
Implication impliesExactly(const Rows& rows, const ExactRow& target, const std::vector<int>& basis) {
  std::vector<Integer> direction = halfSpaces({&target}).front();
  direction.pop_back();
  BoxMaximum maximum = maximiseInBox(halfSpaces(rows), direction, basis);
  Implication result;
  if (!maximum.exists) return result;
  result.holds = target.value.back() >= maximum.objective;
  if (result.holds) {
    result.proof = clearFractions(std::move(maximum.weights), rows, mostBits(rows, &target), target.bits);
  } else {
    result.witness = std::move(maximum.x);
  }
  return result;
}

/// A rounded point moved onto the plane of `on` along the coordinate that moves least.
std::vector<Rational> onPlane(const std::vector<double>& t, const ExactRow* on, int p) {
  std::vector<Rational> point;
  for (int j = 0; j < p; ++j) point.emplace_back(t[static_cast<std::size_t>(j)]);
  if (on == nullptr) return point;
  int k = 0;
  for (int j = 1; j < p; ++j) {
    if (abs(on->value[j]) > abs(on->value[k])) k = j;
  }
  if (on->value[k] == 0) return point;  // a constant row is no plane, and no point lies on it
  Rational sum(on->value.back());
  for (int j = 0; j < p; ++j) {
    if (j != k) sum += on->value[j] * point[j];
  }
  point[k] = -sum / on->value[k];
  return point;
}

/// The largest ball, in floating point. Rows of the guess: the given ones, then `on` and its opposite.
FloatLp::Status guessInterior(const Rows& rows, const ExactRow* on, int p, FloatLp& solver) {
  for (const ExactRow* row : rows) {
    std::vector<double> lifted = row->unit;
    lifted.insert(lifted.end() - 1, row->length > 0.0 ? 1.0 : 0.0);
    solver.add(lifted);
  }
  if (on != nullptr) {
    std::vector<double> lifted = on->unit;
    lifted.insert(lifted.end() - 1, 0.0);
    solver.add(lifted);
    for (double& value : lifted) value = -value;
    solver.add(lifted);
  }
  for (int j = 0; j < 2 * p; ++j) {
    std::vector<double> lifted(static_cast<std::size_t>(p) + 2, 0.0);
    lifted[static_cast<std::size_t>(j / 2)] = j % 2 == 0 ? 1.0 : -1.0;
    lifted[static_cast<std::size_t>(p)] = lifted[static_cast<std::size_t>(p) + 1] = 1.0;
    solver.add(lifted);
  }
  std::vector<double> direction(static_cast<std::size_t>(p) + 1, 0.0);
  direction.back() = 1.0;
  return solver.maximise(direction);
}

/// Rounded weights of a guess that found no ball; `on` and its opposite become one weight of either sign.
FarkasProof emptyByRounding(const FloatLp& solver, const Rows& rows, const ExactRow* on, int bits) {
  const int count = static_cast<int>(rows.size());
  Rows with_plane = rows;
  if (on != nullptr) with_plane.insert(with_plane.end(), 2, on);
  FarkasProof proof = roundWeights(solver.weights(), with_plane, 1.0, bits);
  proof.scale = 1;
  Integer plane(0);
  std::vector<std::pair<int, Integer>> kept;
  for (const auto& [row, weight] : proof.weights) {
    if (row < count) kept.emplace_back(row, weight);
    if (row == count) plane += weight;
    if (row == count + 1) plane -= weight;
  }
  if (plane != 0) kept.emplace_back(count, plane);
  proof.weights = std::move(kept);
  return proof;
}

/// The rows of guessInterior in whole numbers.
std::vector<std::vector<Integer>> liftedRows(const Rows& rows, const ExactRow* on, int p) {
  std::vector<std::vector<Integer>> result;
  const auto lift = [&](const ExactRow& row, int sign, const Integer& radius) {
    std::vector<Integer> lifted;
    for (int j = 0; j < p; ++j) lifted.emplace_back(-sign * row.value[static_cast<std::size_t>(j)]);
    lifted.push_back(radius);
    lifted.emplace_back(sign * row.value.back());
    result.push_back(std::move(lifted));
  };
  for (const ExactRow* row : rows) {
    lift(*row, 1, toInteger(row->length, static_cast<long>(row->bits)) + 1);
  }
  if (on != nullptr) {
    lift(*on, 1, 0);
    lift(*on, -1, 0);
  }
  for (int j = 0; j < 2 * p; ++j) {
    std::vector<Integer> side(static_cast<std::size_t>(p) + 2);
    side[static_cast<std::size_t>(j / 2)] = j % 2 == 0 ? 1 : -1;
    side[static_cast<std::size_t>(p)] = side.back() = 1;
    result.push_back(std::move(side));
  }
  return result;
}

/// As guessInterior, without rounding, first at the basis of the guess.
Interior findExactly(const Rows& rows, const ExactRow* on, int p, const std::vector<int>& basis) {
  std::vector<Integer> direction(static_cast<std::size_t>(p) + 1);
  direction.back() = 1;
  BoxMaximum ball = maximiseInBox(liftedRows(rows, on, p), direction, basis);
  Interior result;
  result.radius = ball.exists ? ball.objective.get_d() : -1.0;
  result.exists = ball.exists && ball.objective > 0;
  if (ball.exists) {
    result.point = std::move(ball.x);
    result.point.pop_back();
  }
  if (result.exists) return result;
  const int count = static_cast<int>(rows.size());
  std::vector<std::pair<int, Rational>> weights;
  Rational plane;
  for (const auto& [row, weight] : ball.weights) {
    if (row < count) weights.emplace_back(row, weight);
    if (on != nullptr && row == count) plane += weight;
    if (on != nullptr && row == count + 1) plane -= weight;
  }
  if (plane != 0) weights.emplace_back(count, plane);
  result.proof = clearFractions(std::move(weights), rows, mostBits(rows, on), on != nullptr ? on->bits : 0);
  return result;
}

FastInterior exactGuess(Interior interior, std::vector<Rational>& point) {
  point = std::move(interior.point);
  return interior.exists ? FastInterior::kExists : FastInterior::kNone;
}

}  // namespace

bool proves(const FarkasProof& proof, const Rows& rows, const ExactRow& target) {
  if (proof.scale <= 0) return false;
  const std::size_t bits = mostBits(rows, &target);
  std::vector<Integer> rest(target.value.size());
  subtract(rest, Integer(-proof.scale), target, bits - target.bits);
  for (const auto& [row, weight] : proof.weights) {
    if (weight < 0) return false;
    subtract(rest, weight, *rows[static_cast<std::size_t>(row)],
             bits - rows[static_cast<std::size_t>(row)]->bits);
  }
  return least(rest) >= 0;
}

Implication implies(const Rows& rows, const ExactRow& target, FloatLp& solver) {
  Implication result;
  result.holds = true;
  if (least(target.value) >= 0) return result;
  if (proveByMultiple(rows, target, result.proof)) return result;
  std::vector<int> basis;
  if (target.length > 0.0) {
    solver.clear();
    for (const ExactRow* row : rows) solver.add(row->unit);
    const std::vector<double> direction(target.unit.begin(), target.unit.end() - 1);
    const FloatLp::Status status = solver.maximise(direction);
    basis = solver.basis();
    if (status == FloatLp::Status::kOptimal) {
      for (const int bits : {kShortBits, kLongBits}) {
        result.proof = roundWeights(solver.weights(), rows, target.length, bits);
        if (proves(result.proof, rows, target)) return result;
      }
      if (proveByBasis(solver, rows, target, result.proof)) return result;
    }
  }
  return impliesExactly(rows, target, basis);
}

bool provesEmpty(const FarkasProof& proof, const Rows& rows, const ExactRow* on) {
  if (rows.empty() && on == nullptr) return false;
  const std::size_t bits = mostBits(rows, on);
  std::vector<Integer> rest((on != nullptr ? on : rows.front())->value.size());  // minus the combination
  bool counts = false;
  for (const auto& [row, weight] : proof.weights) {
    const bool is_plane = row == static_cast<int>(rows.size());
    if (is_plane ? on == nullptr : weight < 0) return false;
    const ExactRow& source = is_plane ? *on : *rows[static_cast<std::size_t>(row)];
    subtract(rest, weight, source, bits - source.bits);
    counts = counts || (!is_plane && weight > 0);
  }
  counts = counts || std::any_of(rest.begin(), rest.end(), [](const Integer& value) { return value != 0; });
  return counts && least(rest) >= 0;
}

bool strictlyInside(const std::vector<Rational>& t, const Rows& rows, const ExactRow* on) {
  if (std::any_of(t.begin(), t.end(), [](const Rational& value) { return abs(value) >= 1; })) return false;
  if (on != nullptr && valueAt(*on, t) != 0) return false;
  return std::all_of(rows.begin(), rows.end(), [&](const ExactRow* row) { return valueAt(*row, t) > 0; });
}

FastInterior findInteriorFast(const Rows& rows, int p, std::vector<Rational>& point) {
  FloatLp solver(p + 1);
  switch (guessInterior(rows, nullptr, p, solver)) {
    case FloatLp::Status::kOptimal:
      point = onPlane(solver.x(), nullptr, p);
      if (solver.objective() > tolerance::kInteriorRadius && strictlyInside(point, rows, nullptr))
        return FastInterior::kExists;
      break;
    case FloatLp::Status::kInfeasible:
      point.clear();
      break;
    case FloatLp::Status::kFailed:
      return exactGuess(findExactly(rows, nullptr, p, solver.basis()), point);
  }
  FarkasProof proof = emptyByRounding(solver, rows, nullptr, kLongBits);
  if (provesEmpty(proof, rows, nullptr) || emptyByBasis(solver, rows, nullptr, p, proof))
    return FastInterior::kNone;
  return point.empty() ? exactGuess(findExactly(rows, nullptr, p, solver.basis()), point)
                       : FastInterior::kUnknown;
}

Interior findInterior(const Rows& rows, const ExactRow* on, int p) {
  FloatLp solver(p + 1);
  const FloatLp::Status status = guessInterior(rows, on, p, solver);
  Interior result;
  if (status == FloatLp::Status::kOptimal && solver.objective() > tolerance::kInteriorRadius) {
    result.radius = solver.objective();
    result.point = onPlane(solver.x(), on, p);
    result.exists = strictlyInside(result.point, rows, on);
    if (result.exists) return result;
  } else if (status != FloatLp::Status::kFailed) {
    result.radius = status == FloatLp::Status::kOptimal ? solver.objective() : -1.0;
    for (const int bits : {kShortBits, kLongBits}) {
      result.proof = emptyByRounding(solver, rows, on, bits);
      if (provesEmpty(result.proof, rows, on)) return result;
    }
    if (emptyByBasis(solver, rows, on, p, result.proof)) return result;
  }
  return findExactly(rows, on, p, solver.basis());
}

}  // namespace polyfly
