#include "program/scaled_program.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "program/program_rows.hpp"
#include "program/tolerances.hpp"

namespace polyfly {
namespace {

// Rounds of the fit.
constexpr int kFitRounds = 12;

/// Greatest |value| of each row of M theta + v in the box.
Eigen::VectorXd sizeInBox(const Eigen::MatrixXd& M, const Eigen::VectorXd& v,
                          const ParametricProgram& program) {
  Eigen::VectorXd centre(M.cols()), half(M.cols());
  for (Eigen::Index j = 0; j < M.cols(); ++j) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(j)];
    centre(j) = 0.5 * signal.lower + 0.5 * signal.upper;
    half(j) = 0.5 * signal.upper - 0.5 * signal.lower;
  }
  return (v + M * centre).cwiseAbs() + M.cwiseAbs() * half;
}

int exponentOf(double size) { return size > 0.0 && std::isfinite(size) ? std::ilogb(size) : 0; }

/// A number of the program that is not zero.
struct Entry {
  Eigen::Index column = 0;  ///< number of variables: the bound
  double size = 0.0;        ///< log2 |value|
  double weight = 1.0;
};

/// By rows. Rows of one entry say nothing.
std::vector<std::vector<Entry>> entriesOf(const ParametricProgram& program) {
  const Eigen::VectorXd bounds = sizeInBox(program.S, program.b, program);
  const Eigen::Index n = program.A.cols();
  std::vector<std::vector<Entry>> rows;
  for (Eigen::Index i = 0; i < program.A.rows(); ++i) {
    std::vector<Entry> row;
    for (Eigen::Index j = 0; j < n; ++j) {
      if (program.A(i, j) != 0.0) row.push_back({j, std::log2(std::abs(program.A(i, j)))});
    }
    if (bounds(i) > 0.0) row.push_back({n, std::log2(bounds(i))});
    if (row.size() > 1) rows.push_back(std::move(row));
  }
  return rows;
}

/// Sizes s of the variables, as binary logarithms: the sizes |a_ij| 2^s_j of a row's terms and that of its bound differ
/// least, in the sum of |logarithms|. So one bound that is far greater than what the others allow does not count. The
/// sum is minimised as one of squares with weights.
Eigen::VectorXd fitSizes(std::vector<std::vector<Entry>> rows, Eigen::Index n) {
  Eigen::VectorXd s = Eigen::VectorXd::Zero(n + 1);
  for (int round = 0; n > 0 && round < kFitRounds; ++round) {
    Eigen::MatrixXd normal = tolerance::kFreeSize * Eigen::MatrixXd::Identity(n + 1, n + 1);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n + 1);
    for (const std::vector<Entry>& row : rows) {
      double total = 0.0, mean = 0.0;
      for (const Entry& entry : row) {
        total += entry.weight;
        mean += entry.weight * entry.size;
      }
      mean /= total;
      for (const Entry& entry : row) {
        normal(entry.column, entry.column) += entry.weight;
        right(entry.column) -= entry.weight * (entry.size - mean);
        for (const Entry& other : row)
          normal(entry.column, other.column) -= entry.weight * other.weight / total;
      }
    }
    s.head(n) = normal.topLeftCorner(n, n).llt().solve(right.head(n));
    for (std::vector<Entry>& row : rows) {
      double total = 0.0, mean = 0.0;
      for (const Entry& entry : row) {
        total += entry.weight;
        mean += entry.weight * (entry.size + s(entry.column));
      }
      for (Entry& entry : row)
        entry.weight = 1.0 / std::max(1.0, std::abs(entry.size + s(entry.column) - mean / total));
    }
  }
  return s.head(n);
}

/// Multiplies row i of M by 2^exponents[i].
void scaleRows(Eigen::MatrixXd& M, const std::vector<int>& exponents) {
  for (Eigen::Index i = 0; i < M.rows(); ++i)
    M.row(i) = M.row(i).unaryExpr(
        [&](double value) { return std::ldexp(value, exponents[static_cast<std::size_t>(i)]); });
}

void scaleRows(Eigen::VectorXd& v, const std::vector<int>& exponents) {
  for (Eigen::Index i = 0; i < v.size(); ++i) v(i) = std::ldexp(v(i), exponents[static_cast<std::size_t>(i)]);
}

void scaleColumns(Eigen::MatrixXd& M, const std::vector<int>& exponents) {
  Eigen::MatrixXd transposed = M.transpose();
  scaleRows(transposed, exponents);
  M = transposed.transpose();
}

void scaleRowsOfProgram(ParametricProgram& program) {
  const Eigen::VectorXd bounds = sizeInBox(program.S, program.b, program);
  std::vector<int> exponents;
  for (Eigen::Index i = 0; i < program.A.rows(); ++i) {
    const double largest = program.A.cols() > 0 ? program.A.row(i).cwiseAbs().maxCoeff() : 0.0;
    exponents.push_back(-exponentOf(largest > 0.0 ? largest : bounds(i)));
  }
  scaleRows(program.A, exponents);
  scaleRows(program.S, exponents);
  scaleRows(program.b, exponents);
}

/// Median of the rows' greatest distances from the unconstrained minimiser, in the metric of H; 0 where there is none.
double distanceOfRows(const ParametricProgram& program) {
  const Eigen::LLT<Eigen::MatrixXd> factor(program.H);
  if (program.H.size() == 0 || factor.info() != Eigen::Success) return 0.0;
  const Eigen::MatrixXd slopes = factor.solve(program.F);
  const Eigen::VectorXd offset = factor.solve(program.f);
  const Eigen::VectorXd slack =
      sizeInBox(program.S + program.A * slopes, program.b + program.A * offset, program);
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < slack.size(); ++i) {
    const double length = factor.matrixL().solve(program.A.row(i).transpose()).norm();
    if (!isEquality(program, static_cast<int>(i)) && length > 0.0 && slack(i) > 0.0)
      distances.push_back(slack(i) / length);
  }
  if (distances.empty()) return 0.0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

// An even power, so that the root of H is multiplied by a power of two. Where H is definite, rows are then about 1 away from
// the unconstrained minimiser: their distances decide what is active, and tolerances of them are absolute.
void scaleCost(ParametricProgram& program) {
  const double curvature = program.H.size() > 0 ? program.H.diagonal().maxCoeff() : 0.0;
  const Eigen::VectorXd slopes = sizeInBox(program.F, program.f, program);
  const double distance = curvature > 0.0 ? distanceOfRows(program) : 0.0;
  const int exponent = distance > 0.0 ? 2 * exponentOf(distance)
                                      : exponentOf(curvature > 0.0     ? curvature
                                                   : slopes.size() > 0 ? slopes.maxCoeff()
                                                                       : 0.0);
  const std::vector<int> all(static_cast<std::size_t>(program.H.rows()), -(exponent - exponent % 2));
  scaleRows(program.H, all);
  scaleRows(program.F, all);
  scaleRows(program.f, all);
}

}  // namespace

ScaledProgram scaleProgram(const ParametricProgram& program) {
  ScaledProgram result{program, {}, {}};
  ParametricProgram& scaled = result.program;
  const Eigen::VectorXd sizes = fitSizes(entriesOf(program), program.A.cols());
  for (Eigen::Index j = 0; j < sizes.size(); ++j)
    result.variables.push_back(static_cast<int>(std::lround(sizes[j])));
  scaleColumns(scaled.A, result.variables);
  scaleColumns(scaled.E, result.variables);
  scaleRows(scaled.H, result.variables);
  scaleColumns(scaled.H, result.variables);
  scaleRows(scaled.F, result.variables);
  scaleRows(scaled.f, result.variables);
  scaleRowsOfProgram(scaled);
  scaleCost(scaled);
  const Eigen::VectorXd offsets = sizeInBox(scaled.C, scaled.c, program);
  std::vector<int> inverse;
  for (Eigen::Index i = 0; i < offsets.size(); ++i) {
    const double free = scaled.E.cols() > 0 ? scaled.E.row(i).cwiseAbs().maxCoeff() : 0.0;
    result.outputs.push_back(exponentOf(std::max(free, offsets(i))));
    inverse.push_back(-result.outputs.back());
  }
  scaleRows(scaled.E, inverse);
  scaleRows(scaled.C, inverse);
  scaleRows(scaled.c, inverse);
  return result;
}

}  // namespace polyfly
