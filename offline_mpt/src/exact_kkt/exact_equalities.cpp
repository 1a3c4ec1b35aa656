#include "exact_kkt/exact_equalities.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "arithmetic/exact_numbers.hpp"
#include "exact_kkt/tolerances.hpp"
#include "mpc_core/decompositions.hpp"
#include "program/equality_check.hpp"
#include "program/program_rows.hpp"

namespace polyfly {
namespace {

bool holds(const std::vector<int>& rows, int row) {
  return std::find(rows.begin(), rows.end(), row) != rows.end();
}

/// The first `columns` entries of (A, S, b) of the rows, without rounding.
IntegerMatrix wholeEqualities(const ParametricProgram& program, const std::vector<int>& rows, int columns) {
  std::vector<Rational> values;
  for (const int row : rows) {
    for (int j = 0; j < columns; ++j) values.emplace_back(rowEntry(program, row, j));
  }
  return wholeRows(values, columns);
}

std::vector<int> exactBasis(const ParametricProgram& program, const std::vector<int>& rows) {
  std::vector<int> basis;
  for (const int k : independentRows(wholeEqualities(program, rows, program.variableCount())))
    basis.push_back(rows[static_cast<std::size_t>(k)]);
  return basis;
}

bool followsExactly(const ParametricProgram& program, std::vector<int> basis, int row) {
  const std::size_t size = basis.size();
  basis.push_back(row);
  const int columns = program.variableCount() + program.parameterCount() + 1;
  return independentRows(wholeEqualities(program, basis, columns)).size() == size;
}

/// Whether all `others` follow from the basis up to rounding.
bool followNearly(const ParametricProgram& program, const std::vector<int>& basis,
                  const std::vector<int>& others) {
  const int n = program.variableCount();
  const Eigen::MatrixXd from = unitColumns(program, basis), to = unitColumns(program, others);
  const Eigen::MatrixXd weights = basis.empty()
                                      ? Eigen::MatrixXd::Zero(0, to.cols())
                                      : PivotedQr(from.topRows(n)).solve(Eigen::MatrixXd(to.topRows(n)));
  const Eigen::MatrixXd rest = to - from * weights;
  for (Eigen::Index k = 0; k < to.cols(); ++k) {
    const double size =
        to.col(k).cwiseAbs().maxCoeff() + (from.cwiseAbs() * weights.col(k).cwiseAbs()).maxCoeff();
    if (rest.col(k).cwiseAbs().maxCoeff() > tolerance::kDependentUpToRounding * size) return false;
  }
  return true;
}

}  // namespace

void chooseBasis(const ParametricProgram& program, const std::vector<int>& rows,
                 ProgramPerturbation& adjustment) {
  adjustment.dropped.clear();
  adjustment.basis.clear();
  if (rows.empty()) return;
  adjustment.basis = exactBasis(program, rows);
  const PivotedQr qr(unitColumns(program, adjustment.basis).topRows(program.variableCount()),
                     tolerance::kDependentUpToRounding);
  std::vector<int> basis, dropped;
  for (Eigen::Index k = 0; k < qr.rank(); ++k)
    basis.push_back(adjustment.basis[static_cast<std::size_t>(qr.column(k))]);
  std::sort(basis.begin(), basis.end());
  for (const int row : rows) {
    if (holds(basis, row) || followsExactly(program, basis, row)) continue;
    if (!isEquality(program, row)) return;
    dropped.push_back(row);
  }
  if (!followNearly(program, basis, dropped)) return;
  adjustment.basis = std::move(basis);
  adjustment.dropped = std::move(dropped);
}

}  // namespace polyfly
