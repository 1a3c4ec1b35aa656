#include "mpc_core/scaled_program.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "mpc_core/identity_form.hpp"

namespace polyfly {
namespace {

// Rounds of the fit.
constexpr int kFitRounds = 12;
// Weight by which the size of a variable that no bound gives one is that of its unit.
constexpr double kFreeSize = 1e-9;
// Ratio of curvatures up to which the rows measure the variables.
constexpr double kMostSpread = 0x1p40;

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
    Eigen::MatrixXd normal = kFreeSize * Eigen::MatrixXd::Identity(n + 1, n + 1);
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
  const auto is_equality = [&](Eigen::Index row) {
    return std::find(program.equalities.begin(), program.equalities.end(), row) != program.equalities.end();
  };
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < slack.size(); ++i) {
    const double length = factor.matrixL().solve(program.A.row(i).transpose()).norm();
    if (!is_equality(i) && length > 0.0 && slack(i) > 0.0) distances.push_back(slack(i) / length);
  }
  if (distances.empty()) return 0.0;
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  return *middle;
}

/// The program in z / 2^exponents.
void scaleVariables(ScaledProgram& scaled, const std::vector<int>& exponents) {
  ParametricProgram& program = scaled.program;
  scaleColumns(program.A, exponents);
  scaleColumns(program.E, exponents);
  scaleRows(program.H, exponents);
  scaleColumns(program.H, exponents);
  scaleRows(program.F, exponents);
  scaleRows(program.f, exponents);
  std::transform(exponents.begin(), exponents.end(), scaled.variables.begin(), scaled.variables.begin(),
                 std::plus<int>());
}

void scaleCost(ScaledProgram& scaled, int exponent) {
  const std::vector<int> all(scaled.variables.size(), exponent);
  scaleRows(scaled.program.H, all);
  scaleRows(scaled.program.F, all);
  scaleRows(scaled.program.f, all);
  scaled.cost += exponent;
}

/// Exponents of the sizes, as binary logarithms.
std::vector<int> exponentsOf(const Eigen::VectorXd& sizes) {
  std::vector<int> result(static_cast<std::size_t>(sizes.size()));
  std::transform(sizes.data(), sizes.data() + sizes.size(), result.begin(),
                 [](double size) { return static_cast<int>(std::lround(size)); });
  return result;
}

/// Variables by the curvature of the cost; then all by the distance of the rows.
void scaleByCost(ScaledProgram& scaled) {
  const auto log2 = [](double value) { return std::log2(value); };
  scaleVariables(scaled, exponentsOf(-0.5 * scaled.program.H.diagonal().unaryExpr(log2)));
  const int distance = exponentOf(distanceOfRows(scaled.program));
  scaleVariables(scaled, std::vector<int>(scaled.variables.size(), distance));
  scaleCost(scaled, -2 * distance);
}

/// The cost is multiplied by an even power, so that a root of H is multiplied by a power of two. Where H is definite, rows are
/// then about 1 away from the unconstrained minimiser: their distances decide what is active, and tolerances of them are
/// absolute.
void scaleByRows(ScaledProgram& scaled) {
  ParametricProgram& program = scaled.program;
  scaleVariables(scaled, exponentsOf(fitSizes(entriesOf(program), program.A.cols())));
  const double curvature = program.H.size() > 0 ? program.H.diagonal().maxCoeff() : 0.0;
  const Eigen::VectorXd slopes = sizeInBox(program.F, program.f, program);
  const double distance = curvature > 0.0 ? distanceOfRows(program) : 0.0;
  const int exponent = exponentOf(curvature > 0.0 ? curvature : slopes.size() > 0 ? slopes.maxCoeff() : 0.0);
  scaleCost(scaled, distance > 0.0 ? -2 * exponentOf(distance) : exponent % 2 - exponent);
}

/// Greatest curvature over the least one.
double spreadOf(const ParametricProgram& program) {
  const Eigen::VectorXd curvatures = program.H.diagonal();
  return curvatures.size() > 0 ? curvatures.maxCoeff() / curvatures.minCoeff() : 1.0;
}

/// Whether it is the rows that spread the curvatures of a definite cost so far that some are lost beside others, as rows do
/// whose entries decay.
bool isSpreadByRows(const ScaledProgram& scaled, const ParametricProgram& given) {
  const double spread = spreadOf(scaled.program);
  return !(spread <= kMostSpread) && !(spread <= spreadOf(given));
}

void scaleOutputs(ScaledProgram& scaled) {
  ParametricProgram& program = scaled.program;
  const Eigen::VectorXd offsets = sizeInBox(program.C, program.c, program);
  std::vector<int> inverse;
  for (Eigen::Index i = 0; i < offsets.size(); ++i) {
    const double free = program.E.cols() > 0 ? program.E.row(i).cwiseAbs().maxCoeff() : 0.0;
    scaled.outputs.push_back(exponentOf(std::max(free, offsets(i))));
    inverse.push_back(-scaled.outputs.back());
  }
  scaleRows(program.E, inverse);
  scaleRows(program.C, inverse);
  scaleRows(program.c, inverse);
}

}  // namespace

ScaledProgram scaleProgram(const ParametricProgram& program) {
  const ScaledProgram given{program, std::vector<int>(static_cast<std::size_t>(program.A.cols()), 0), {}, 0};
  ScaledProgram scaled = given;
  scaleByRows(scaled);
  if (isSpreadByRows(scaled, program) && choleskyRoot(wide(program.H))) {
    scaled = given;
    scaleByCost(scaled);
  }
  scaleRowsOfProgram(scaled.program);
  scaleOutputs(scaled);
  return scaled;
}

}  // namespace polyfly
