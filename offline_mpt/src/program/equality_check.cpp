#include "program/equality_check.hpp"

#include <algorithm>
#include <cstdio>
#include <string>

#include "mpc_core/decompositions.hpp"
#include "mpc_core/scaled_program.hpp"
#include "polyfly_base/error.hpp"
#include "program/tolerances.hpp"

namespace polyfly {
namespace {

[[noreturn]] void refuse(const ParametricProgram& program, int row, const char* rule, double distance) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g", distance);
  throw Error(program.name + ": eq_ids: row " + std::to_string(row) + " " + rule + " (relative distance " +
              text + ")");
}

/// Columns of the rows that `qr` counts as independent, or of the others.
Eigen::MatrixXd columnsFrom(const Eigen::MatrixXd& all, const PivotedQr& qr, Eigen::Index begin,
                            Eigen::Index end) {
  Eigen::MatrixXd result(all.rows(), end - begin);
  for (Eigen::Index k = begin; k < end; ++k) result.col(k - begin) = all.col(qr.column(k));
  return result;
}

}  // namespace

Eigen::MatrixXd unitColumns(const ParametricProgram& program, const std::vector<int>& rows) {
  const int n = program.variableCount(), p = program.parameterCount();
  Eigen::MatrixXd result(n + p + 1, static_cast<Eigen::Index>(rows.size()));
  for (Eigen::Index k = 0; k < result.cols(); ++k) {
    const int row = rows[static_cast<std::size_t>(k)];
    result.col(k).head(n) = program.A.row(row);
    result(n + p, k) = program.b(row);
    for (int j = 0; j < p; ++j) {
      const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
      result(n + j, k) = program.S(row, j) * 0.5 * (signal.upper - signal.lower);
      result(n + p, k) += program.S(row, j) * 0.5 * (signal.upper + signal.lower);
    }
    const double length = result.col(k).head(n).norm();
    if (length > 0.0) result.col(k) /= length;
  }
  return result;
}

void checkEqualities(const ParametricProgram& given) {
  if (given.equalities.size() < 2) return;
  const ParametricProgram program = scaleProgram(given).program;
  const int n = program.variableCount();
  const Eigen::MatrixXd columns = unitColumns(program, program.equalities);
  const PivotedQr clear(columns.topRows(n), tolerance::kClearEquality);
  const Eigen::Index rank = clear.rank(), count = columns.cols();
  if (rank == count) return;
  const Eigen::MatrixXd from = columnsFrom(columns, clear, 0, rank);
  const Eigen::MatrixXd to = columnsFrom(columns, clear, rank, count);
  const Eigen::MatrixXd weights = PivotedQr(from.topRows(n)).solve(Eigen::MatrixXd(to.topRows(n)));
  const Eigen::MatrixXd rest = to - from * weights;
  for (Eigen::Index k = 0; k < rest.cols(); ++k) {
    const int row = program.equalities[static_cast<std::size_t>(clear.column(rank + k))];
    const double distance = rest.col(k).head(n).norm();
    if (distance > tolerance::kDependentEquality)
      refuse(program, row, "nearly depends on other equalities, so rounding decides what it fixes", distance);
    const double difference = rest.col(k).tail(rest.rows() - n).cwiseAbs().sum();
    const double size =
        to.col(k).cwiseAbs().maxCoeff() + (from.cwiseAbs() * weights.col(k).cwiseAbs()).maxCoeff();
    if (difference > std::max(tolerance::kDependentEquality, tolerance::kSideRounding * size))
      refuse(program, row, "depends on other equalities, but its right-hand side does not", difference);
  }
}

}  // namespace polyfly
