#include "certify/implied.hpp"

#include <algorithm>

#include "offline_mpt/exact_lp.hpp"
#include "program/program_rows.hpp"

namespace polyfly {
namespace {

/// The least weights of rows, those of inequalities at least zero and of the rows in `needed` at least one,
/// that cancel all numbers of (A, S, b); empty if there are none.
ZeroCombination combineToZero(const ParametricProgram& program, const std::vector<int>& rows,
                              const std::vector<int>& needed) {
  const int entries = program.variableCount() + program.parameterCount() + 1;
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

}  // namespace

bool proveImplied(const ParametricProgram& program, const std::vector<int>& rows,
                  ProgramPerturbation& adjustment) {
  ZeroCombination proof = combineToZero(program, rows, rows);
  if (proof.empty()) return false;
  adjustment.implied.push_back(std::move(proof));
  return true;
}

}  // namespace polyfly
