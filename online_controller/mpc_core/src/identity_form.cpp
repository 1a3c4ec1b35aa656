#include "mpc_core/identity_form.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

/// (M v), v as last column.
WideMatrix joined(const Eigen::MatrixXd& M, const Eigen::VectorXd& v) {
  WideMatrix result(v.size(), M.cols() + 1);
  result.leftCols(M.cols()) = wide(M);
  result.col(M.cols()) = wide(v);
  return result;
}

}  // namespace

AffineProgram affineProgram(const ParametricProgram& program) {
  return {wide(program.H), joined(program.F, program.f), wide(program.A), joined(program.S, program.b),
          wide(program.E), joined(program.C, program.c)};
}

std::optional<WideMatrix> choleskyRoot(const WideMatrix& H) {
  const Eigen::LLT<WideMatrix> factor(H);
  if (factor.info() != Eigen::Success) return std::nullopt;
  WideMatrix root = factor.matrixL();
  // What rounding may have made of a pivot that is zero.
  const double rounding = static_cast<double>(H.rows()) * 16.0 * kDoubleDoubleUnit;
  for (Eigen::Index i = 0; i < H.rows(); ++i) {
    const double pivot = root(i, i).high;
    if (!(pivot * pivot > rounding * H(i, i).high)) return std::nullopt;
  }
  return root;
}

std::optional<IdentityForm> identityForm(const AffineProgram& program) {
  const std::optional<WideMatrix> root = choleskyRoot(program.H);
  if (!root) return std::nullopt;
  IdentityForm form;
  form.root = *root;
  const auto L = form.root.triangularView<Eigen::Lower>();
  for (Eigen::Index i = 0; i < program.H.rows(); ++i)
    form.root_condition =
        std::max(form.root_condition, std::sqrt(program.H(i, i).high) / form.root(i, i).high);
  const WideMatrix free = -L.solve(program.cost);
  form.rows = L.solve(program.A.transpose()).transpose();
  form.slack = program.bound - form.rows * free;
  form.length = Eigen::VectorXd::Ones(form.rows.rows());
  for (Eigen::Index i = 0; i < form.rows.rows(); ++i) {
    DoubleDouble squared;
    for (Eigen::Index j = 0; j < form.rows.cols(); ++j) squared += form.rows(i, j) * form.rows(i, j);
    if (squared.high == 0.0) continue;
    const DoubleDouble length = sqrt(squared);
    form.length(i) = length.high;
    form.rows.row(i) /= length;
    form.slack.row(i) /= length;
  }
  form.output = L.solve(program.E.transpose()).transpose();
  form.law = program.offset + form.output * free;
  return form;
}

}  // namespace polyfly
