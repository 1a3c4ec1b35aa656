#include "lp/box_maximum.hpp"

#include <algorithm>

#include "offline_mpt/exact_lp.hpp"

namespace polyfly {
namespace {

ExactLp boxProgram(const std::vector<std::vector<Integer>>& rows, const std::vector<Integer>& c) {
  const int dimension = static_cast<int>(c.size()), count = static_cast<int>(rows.size());
  ExactLp lp;
  lp.setSense(ExactLp::Sense::kMaximise);
  lp.addColumns(dimension);
  lp.addRows(count);
  for (int j = 0; j < dimension; ++j) {
    lp.setColumnBounds(j, ExactLp::Bound::kDouble, -1, 1);
    lp.setObjective(j, Rational(c[static_cast<std::size_t>(j)]));
  }
  for (int i = 0; i < count; ++i) {
    const std::vector<Integer>& row = rows[static_cast<std::size_t>(i)];
    lp.setRowBounds(i, ExactLp::Bound::kUpper, 0, Rational(row.back()));
    for (int j = 0; j < dimension; ++j) {
      const Integer& entry = row[static_cast<std::size_t>(j)];
      if (entry != 0) lp.setCoefficient(i, j, Rational(entry));
    }
  }
  return lp;
}

/// A row, or the side of the box that has this index in a basis.
std::vector<Integer> basicRow(const std::vector<std::vector<Integer>>& rows, int index,
                              std::size_t dimension) {
  const auto at = static_cast<std::size_t>(index);
  if (at < rows.size()) return rows[at];
  std::vector<Integer> side(dimension + 1);
  side[(at - rows.size()) / 2] = (at - rows.size()) % 2 == 0 ? 1 : -1;
  side.back() = 1;
  return side;
}

/// The last column of a solved system, over the determinant.
std::vector<Rational> solution(const IntegerMatrix& system, const Integer& determinant) {
  std::vector<Rational> result;
  for (int k = 0; k < system.rows(); ++k) {
    result.emplace_back(system(k, system.columns() - 1), determinant);
    result.back().canonicalize();
  }
  return result;
}

/// Whether a . x <= b where x is `solved`, over the determinant.
bool holds(const std::vector<Integer>& a_b, const IntegerMatrix& solved, const Integer& determinant) {
  Integer sum = -a_b.back() * determinant;
  for (int j = 0; j < solved.rows(); ++j)
    mpz_addmul(sum.get_mpz_t(), a_b[static_cast<std::size_t>(j)].get_mpz_t(),
               solved(j, solved.columns() - 1).get_mpz_t());
  return sum <= 0;
}

/// False where the basis is not that of a maximum.
bool maximumAt(const std::vector<int>& basis, const std::vector<std::vector<Integer>>& rows,
               const std::vector<Integer>& c, BoxMaximum& result) {
  const int dimension = static_cast<int>(c.size());
  if (static_cast<int>(basis.size()) != dimension) return false;
  IntegerMatrix primal(dimension, dimension + 1), dual(dimension, dimension + 1);
  for (int k = 0; k < dimension; ++k) {
    const std::vector<Integer> row = basicRow(rows, basis[static_cast<std::size_t>(k)], c.size());
    for (int j = 0; j < dimension; ++j) primal(k, j) = dual(j, k) = row[static_cast<std::size_t>(j)];
    primal(k, dimension) = row.back();
    dual(k, dimension) = c[static_cast<std::size_t>(k)];
  }
  Integer determinant;
  if (!solveExactly(dual, determinant)) return false;
  const std::vector<Rational> weights = solution(dual, determinant);
  if (std::any_of(weights.begin(), weights.end(), [](const Rational& weight) { return weight < 0; }))
    return false;
  if (!solveExactly(primal, determinant)) return false;
  for (int j = 0; j < dimension; ++j) {
    if (abs(primal(j, dimension)) > determinant) return false;
  }
  if (!std::all_of(rows.begin(), rows.end(),
                   [&](const auto& row) { return holds(row, primal, determinant); }))
    return false;
  result.x = solution(primal, determinant);
  result.exists = true;
  for (std::size_t j = 0; j < c.size(); ++j) result.objective += c[j] * result.x[j];
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] > 0 && basis[k] < static_cast<int>(rows.size()))
      result.weights.emplace_back(basis[k], weights[k]);
  }
  return true;
}

}  // namespace

BoxMaximum maximiseInBox(const std::vector<std::vector<Integer>>& rows, const std::vector<Integer>& c,
                         const std::vector<int>& basis) {
  BoxMaximum result;
  if (maximumAt(basis, rows, c, result)) return result;
  result = {};
  ExactLp lp = boxProgram(rows, c);
  result.exists = lp.solve() == ExactLp::Status::kOptimal;
  for (int i = 0; i < lp.rowCount(); ++i) {
    // Of a contradiction, rays at upper bounds are negative.
    const Rational weight = result.exists ? lp.rowDual(i) : -lp.rowRay(i);
    if (weight > 0) result.weights.emplace_back(i, weight);
  }
  if (!result.exists) return result;
  result.objective = lp.objective();
  for (int j = 0; j < lp.columnCount(); ++j) result.x.push_back(lp.primal(j));
  return result;
}

}  // namespace polyfly
