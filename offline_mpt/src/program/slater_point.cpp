#include "program/slater_point.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mpc_core/dense_qp.hpp"
#include "mpc_core/scaled_program.hpp"
#include "polyfly_base/error.hpp"
#include "program/program_rows.hpp"
#include "program/tolerances.hpp"

namespace polyfly {
namespace {

/// max r over (z, t, r): rows of the program in scaled parameters with slack r, r <= 1. Box rows follow, then
/// A_theta's.
struct SlaterSearch {
  Eigen::MatrixXd A;
  Eigen::VectorXd b;
  int domain = 0;  ///< first row of the parameters' own
};

/// Rows of length one.
void normalise(SlaterSearch& search) {
  for (Eigen::Index i = 0; i + 1 < search.A.rows(); ++i) {
    const double length = search.A.row(i).norm();
    const double largest = std::max(search.A.row(i).cwiseAbs().maxCoeff(), std::abs(search.b(i)));
    if (length <= tolerance::kNoNormal * largest || length == 0.0) continue;
    search.A.row(i) /= length;
    search.b(i) /= length;
  }
}

SlaterSearch assemble(const ParametricProgram& program) {
  const int n = program.variableCount();
  const int p = program.parameterCount();
  const int m = program.rowCount();
  const int k = static_cast<int>(program.A_theta.rows());
  Eigen::VectorXd centre(p), half(p);
  for (int j = 0; j < p; ++j) {
    centre(j) = 0.5 * (program.parameters[j].lower + program.parameters[j].upper);
    half(j) = 0.5 * (program.parameters[j].upper - program.parameters[j].lower);
  }
  SlaterSearch search;
  search.domain = m;
  search.A = Eigen::MatrixXd::Zero(m + 2 * p + k + 1, n + p + 1);
  search.b = Eigen::VectorXd::Zero(m + 2 * p + k + 1);
  search.A.topLeftCorner(m, n) = program.A;
  search.A.block(0, n, m, p) = -program.S * half.asDiagonal();
  search.b.head(m) = program.b + program.S * centre;
  for (int j = 0; j < p; ++j) {
    search.A(m + 2 * j, n + j) = 1.0;
    search.A(m + 2 * j + 1, n + j) = -1.0;
    search.b.segment(m + 2 * j, 2).setOnes();
  }
  if (k > 0) {
    search.A.block(m + 2 * p, n, k, p) = program.A_theta * half.asDiagonal();
    search.b.segment(m + 2 * p, k) = program.b_theta - program.A_theta * centre;
  }
  normalise(search);
  for (Eigen::Index i = 0; i < search.A.rows(); ++i) {
    const bool says_nothing = search.A.row(i).isZero(0.0) && search.b(i) >= 0.0;
    search.A(i, n + p) = says_nothing ? 0.0 : 1.0;
  }
  for (const int row : program.equalities) search.A(row, n + p) = 0.0;
  search.A(search.A.rows() - 1, n + p) = 1.0;
  search.b(search.b.size() - 1) = 1.0;
  return search;
}

/// Pairs of rows that are each other's negative, of which the search, in doubles, may just see a margin.
void addOpposite(ParametricProgram& program) {
  const Eigen::Index n = program.A.cols(), p = program.S.cols();
  Eigen::MatrixXd rows(program.A.rows(), n + p + 1);
  rows << program.A, program.S, program.b;
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    const double length = program.A.row(i).norm();
    rows.row(i) *= length > 0.0 ? 1.0 / length : 0.0;
  }
  for (int i = 0; i < program.rowCount(); ++i) {
    for (int k = 0; k < i && !rows.row(i).isZero(0.0); ++k) {
      const double size = rows.row(i).cwiseAbs().maxCoeff();
      if ((rows.row(i) + rows.row(k)).cwiseAbs().maxCoeff() > tolerance::kOppositeRows * size) continue;
      for (const int row : {i, k}) {
        if (!isEquality(program, row)) program.equalities.push_back(row);
      }
    }
  }
  std::sort(program.equalities.begin(), program.equalities.end());
}

/// Rows that keep the margin at zero; false when only the parameters' own rows do.
bool addImplied(const DenseQp& qp, const SlaterSearch& search, ParametricProgram& program) {
  bool added = false;
  for (int row = 0; row < search.domain; ++row) {
    if (qp.lambda()(row) <= tolerance::kBlockingShare) continue;
    if (isEquality(program, row)) continue;
    program.equalities.push_back(row);
    added = true;
  }
  std::sort(program.equalities.begin(), program.equalities.end());
  return added;
}

SlaterPoint findScaledPoint(ParametricProgram& program) {
  const int n = program.variableCount();
  const int p = program.parameterCount();
  addOpposite(program);
  for (;;) {
    const SlaterSearch search = assemble(program);
    const Eigen::MatrixXd H = tolerance::kSlaterWeight * Eigen::MatrixXd::Identity(n + p + 1, n + p + 1);
    Eigen::VectorXd g = Eigen::VectorXd::Zero(n + p + 1);
    g(n + p) = -1.0;
    DenseQp qp(H, search.A, program.equalities);
    if (qp.solve(g.data(), search.b.data()) != QpStatus::kOptimal) return {};
    const double margin = qp.z()(n + p);
    if (margin < -tolerance::kMarginRounding)
      return {};  // nearer to zero, it is for the rows as equalities to contradict
    if (margin > tolerance::kLeastMargin) return {true, qp.z().segment(n, p)};
    if (!addImplied(qp, search, program)) {
      throw Error(program.name + ": the parameters that admit a solution form a lower-dimensional set");
    }
  }
}

}  // namespace

SlaterPoint findSlaterPoint(ParametricProgram& program) {
  ParametricProgram scaled = scaleProgram(program).program;
  const SlaterPoint point = findScaledPoint(scaled);
  program.equalities = std::move(scaled.equalities);
  return point;
}

}  // namespace polyfly
