#include "certify/implied.hpp"

#include <algorithm>
#include <set>

#include "offline_mpt/exact_lp.hpp"
#include "program/program_rows.hpp"

namespace polyfly {
namespace {

/// The least weights of rows, those of inequalities at least zero and of the rows in `needed` at least one,
/// that cancel the first `entries` numbers of (A, S, b); empty if there are none.
ZeroCombination combineToZero(const ParametricProgram& program, const std::vector<int>& rows,
                              const std::vector<int>& needed, int entries) {
  ExactLp lp;
  lp.addRows(entries);
  for (int i = 0; i < entries; ++i) lp.setRowBounds(i, ExactLp::Bound::kFixed, 0, 0);
  lp.addColumns(static_cast<int>(rows.size()));
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const int column = static_cast<int>(k);
    const bool equality = isEquality(program, rows[k]);
    const bool is_needed = std::find(needed.begin(), needed.end(), rows[k]) != needed.end();
    lp.setColumnBounds(column, equality ? ExactLp::Bound::kFree : ExactLp::Bound::kLower, is_needed ? 1 : 0,
                       0);
    lp.setObjective(column, equality ? 0 : 1);
    for (int i = 0; i < entries; ++i) {
      const double value = rowEntry(program, rows[k], i);
      if (value != 0.0) lp.setCoefficient(i, column, Rational(value));
    }
  }
  if (lp.solve() != ExactLp::Status::kOptimal) return {};
  Integer denominator(1);
  for (int k = 0; k < lp.columnCount(); ++k) denominator = lcm(denominator, lp.primal(k).get_den());
  ZeroCombination result;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const Rational weight = lp.primal(static_cast<int>(k)) * denominator;
    if (weight != 0) result.emplace_back(rows[k], weight.get_num());
  }
  return result;
}

/// What is left over where rows cancel but for their bounds is taken from the bounds of all, by the size of
/// their rows. False where that is more than kNarrowBits allows.
bool closeGap(const ParametricProgram& program, const ZeroCombination& proof,
              ProgramPerturbation& adjustment) {
  std::vector<Rational> sizes;
  Rational gap, size;
  for (const auto& [row, weight] : proof) {
    sizes.push_back(rowSum(program, row));
    gap += weight * Rational(program.b(row));
    size += abs(weight) * sizes.back();
  }
  if (abs(gap) * Rational(Integer(1) << kNarrowBits) > size) return false;
  for (std::size_t k = 0; gap != 0 && k < proof.size(); ++k) {
    const auto& [row, weight] = proof[k];
    adjustment.bounds.emplace_back(row, Rational(program.b(row)) - sgn(weight) * gap * sizes[k] / size);
  }
  return true;
}

/// One combination for each group of rows that hold each other; none of them may share a row.
bool proveNarrow(const ParametricProgram& program, const std::vector<int>& rows,
                 ProgramPerturbation& adjustment) {
  std::set<int> proven;
  for (const int row : rows) {
    if (isEquality(program, row) || proven.count(row) > 0) continue;
    ZeroCombination proof =
        combineToZero(program, rows, {row}, program.variableCount() + program.parameterCount());
    if (proof.empty()) return false;
    for (const auto& [other, weight] : proof) {
      if (!proven.insert(other).second) return false;
    }
    if (!closeGap(program, proof, adjustment)) return false;
    adjustment.implied.push_back(std::move(proof));
  }
  return true;
}

}  // namespace

bool proveImplied(const ParametricProgram& program, const std::vector<int>& rows,
                  ProgramPerturbation& adjustment) {
  ZeroCombination proof =
      combineToZero(program, rows, rows, program.variableCount() + program.parameterCount() + 1);
  if (!proof.empty()) {
    adjustment.implied.push_back(std::move(proof));
    return true;
  }
  ProgramPerturbation narrow = adjustment;
  if (!proveNarrow(program, rows, narrow)) return false;
  adjustment = std::move(narrow);
  return true;
}

}  // namespace polyfly
