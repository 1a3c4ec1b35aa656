#include "verify/exact_sample.hpp"

#include <cmath>

#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

using Bound = ExactLp::Bound;

/// Entry `row` of M x, where x are the columns from `first` on.
void setRow(ExactLp& lp, int at, const Eigen::MatrixXd& M, int row, int first) {
  for (int j = 0; j < M.cols(); ++j) {
    if (M(row, j) != 0.0) lp.setCoefficient(at, first + j, Rational(M(row, j)));
  }
}

/// expression <= bound, in a new row of it.
int addRowBelow(ExactLp& lp, const Rational& bound) {
  const int row = lp.addRows(1);
  lp.setRowBounds(row, Bound::kUpper, 0, bound);
  return row;
}

}  // namespace

Rational ExactSample::valueAt(const Eigen::MatrixXd& rows, const Eigen::VectorXd& constants, int row) const {
  Rational value(constants[row]);
  for (Eigen::Index j = 0; j < theta_.size(); ++j) {
    if (rows(row, j) != 0.0) value += Rational(rows(row, j)) * Rational(theta_[j]);
  }
  return value;
}

// b - a . theta of a row of the parameter set.
Rational ExactSample::roomInSet(int row) const { return valueAt(-program_.A_theta, program_.b_theta, row); }

// Columns z, rows of the program.
ExactLp ExactSample::rowsAtTheta() const {
  ExactLp lp;
  lp.addColumns(program_.variableCount(), Bound::kFree);
  lp.addRows(program_.rowCount());
  for (int i = 0; i < program_.rowCount(); ++i) {
    lp.setRowBounds(i, Bound::kUpper, 0, valueAt(program_.S, program_.b, i));
    setRow(lp, i, program_.A, i, 0);
  }
  for (const int i : program_.equalities)
    lp.setRowBounds(i, Bound::kFixed, valueAt(program_.S, program_.b, i), 0);
  return lp;
}

void ExactSample::setCost(ExactLp& lp) const {
  if (!program_.H.isZero(0.0)) return;
  for (int j = 0; j < program_.variableCount(); ++j) lp.setObjective(j, valueAt(program_.F, program_.f, j));
}

ExactLp::Status ExactSample::status() const {
  for (int i = 0; i < program_.A_theta.rows(); ++i) {
    if (roomInSet(i) < 0) return ExactLp::Status::kInfeasible;
  }
  ExactLp lp = rowsAtTheta();
  setCost(lp);
  return lp.solve();
}

// Columns z, changes d of theta in half-ranges, r: min r, |d_j| <= r.
std::optional<ExactSample::Nearest> ExactSample::nearestFeasible() const {
  const int p = program_.parameterCount();
  const auto half = [&](int j) {
    const Signal& signal = program_.parameters[static_cast<std::size_t>(j)];
    return Rational((Rational(signal.upper) - Rational(signal.lower)) / 2);
  };
  ExactLp lp = rowsAtTheta();
  const int d = lp.addColumns(p), r = lp.addColumns(1);
  lp.setObjective(r, 1);
  const auto moved = [&](int row, const Eigen::MatrixXd& M, int i, int sign) {
    for (int j = 0; j < p; ++j) {
      if (M(i, j) != 0.0) lp.setCoefficient(row, d + j, sign * half(j) * Rational(M(i, j)));
    }
  };
  for (int i = 0; i < program_.rowCount(); ++i) moved(i, program_.S, i, -1);
  for (int i = 0; i < program_.A_theta.rows(); ++i)
    moved(addRowBelow(lp, roomInSet(i)), program_.A_theta, i, 1);
  for (int j = 0; j < p; ++j) {
    const Signal& signal = program_.parameters[static_cast<std::size_t>(j)];
    const Rational theta(theta_[j]);
    lp.setColumnBounds(d + j, Bound::kDouble, (Rational(signal.lower) - theta) / half(j),
                       (Rational(signal.upper) - theta) / half(j));
    for (const int sign : {-1, 1}) {
      const int row = addRowBelow(lp, 0);
      lp.setCoefficient(row, d + j, sign);
      lp.setCoefficient(row, r, -1);
    }
  }
  if (lp.solve() != ExactLp::Status::kOptimal) return std::nullopt;
  Nearest nearest{theta_, lp.objective().get_d()};
  for (int j = 0; j < p; ++j)
    nearest.theta[j] = Rational(Rational(theta_[j]) + half(j) * lp.primal(d + j)).get_d();
  return nearest;
}

// Among the z whose cost is the least one but for rounding, the greatest share t of |u - E z - C theta - c| is least.
Eigen::VectorXd ExactSample::nearestOptimum(const Eigen::VectorXd& u, const Eigen::VectorXd& ranges) const {
  ExactLp lp = rowsAtTheta();
  setCost(lp);
  lp.solve();
  const int n = program_.variableCount(), optimal = lp.addRows(1);
  const Rational least = lp.objective();
  Rational size;
  for (int j = 0; j < n; ++j) size += abs(valueAt(program_.F, program_.f, j) * lp.primal(j));
  lp.setRowBounds(optimal, Bound::kUpper, 0, least + Rational(tolerance::kTiedCost) * size);
  for (int j = 0; j < n; ++j) {
    lp.setCoefficient(optimal, j, valueAt(program_.F, program_.f, j));
    lp.setObjective(j, 0);
  }
  const int t = lp.addColumns(1);
  lp.setObjective(t, 1);
  for (int k = 0; k < program_.inputCount(); ++k) {
    const Rational rest = Rational(u[k]) - valueAt(program_.C, program_.c, k);
    for (const int sign : {-1, 1}) {
      const int row = addRowBelow(lp, sign * rest);
      setRow(lp, row, sign * program_.E, k, 0);
      lp.setCoefficient(row, t, Rational(-ranges[k]));
    }
  }
  lp.solve();
  Eigen::VectorXd nearest(u.size());
  for (int k = 0; k < program_.inputCount(); ++k) {
    Rational value = valueAt(program_.C, program_.c, k);
    for (int j = 0; j < n; ++j) value += Rational(program_.E(k, j)) * lp.primal(j);
    nearest[k] = value.get_d();
  }
  return nearest;
}

}  // namespace polyfly
