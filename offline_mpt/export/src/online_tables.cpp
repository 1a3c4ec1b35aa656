#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "export_proven/online_code.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Squared length, relative to that of the row itself, up to which a row is 0 z <= b + S theta.
constexpr double kNoRow = 1e-26;
// Share of a condition's terms that it may be negative by.
constexpr double kConditionTolerance = 1e-12;

using Row = Eigen::RowVectorXd;

void append(std::vector<double>& numbers, const Row& row) {
  numbers.insert(numbers.end(), row.data(), row.data() + row.size());
}

struct Side {
  bool is_negated = false;
  Row limit;
  std::uint32_t origin = 0;
};

/// Collects the sides of a program's rows. Rows of the same direction share one row of the tables.
class SideCollector {
 public:
  explicit SideCollector(OnlineTables& tables) : tables_(tables) {}

  /// a . v <= limit, where a has unit length.
  void add(const Row& a, const Row& limit, Eigen::Index origin) {
    const auto row = static_cast<std::uint32_t>(origin);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      if (rows_[i] == a) return sides_[i].push_back({false, limit, row});
      if (rows_[i] == -a) return sides_[i].push_back({true, limit, row});
    }
    rows_.push_back(a);
    sides_.push_back({{false, limit, row}});
  }

  void finish() {
    for (std::size_t i = 0; i < rows_.size(); ++i) {
      append(tables_.rows, rows_[i]);
      for (const Side& side : sides_[i]) {
        tables_.sides.push_back(2 * static_cast<std::uint32_t>(i) + (side.is_negated ? 1 : 0));
        tables_.origins.push_back(side.origin);
        append(tables_.limits, side.limit);
      }
    }
  }

 private:
  OnlineTables& tables_;
  std::vector<Row> rows_;
  std::vector<std::vector<Side>> sides_;
};

/// A row without variables, 0 <= limit, relaxed by rounding.
Row condition(const ParametricProgram& program, Row limit) {
  const Eigen::Index p = program.parameterCount();
  double size = std::abs(limit(p));
  for (Eigen::Index k = 0; k < p; ++k) {
    const Signal& signal = program.parameters[static_cast<std::size_t>(k)];
    size += std::abs(limit(k)) * std::max(std::abs(signal.lower), std::abs(signal.upper));
  }
  limit(p) += kConditionTolerance * size;
  return limit;
}

}  // namespace

OnlineTables onlineTables(const ParametricProgram& program) {
  const Eigen::Index n = program.variableCount();
  const Eigen::Index p = program.parameterCount();
  if (p == 0) throw Error(program.name + ": parameters: the online solver needs at least one");
  const Eigen::LLT<Eigen::MatrixXd> cholesky(program.H);
  if (cholesky.info() != Eigen::Success)
    throw Error(program.name + ": H: must be positive definite to be solved online");
  OnlineTables tables;
  tables.program_name = program.name;
  tables.problem_text = program.text;
  tables.parameters = program.parameters;
  tables.inputs = program.inputs;
  tables.variables = static_cast<std::uint32_t>(n);

  // v = L' (z - z_free) with H = L L', and z_free = -H^-1 (f + F theta).
  Eigen::MatrixXd gradient(n, p + 1);
  gradient << program.F, program.f;
  const Eigen::MatrixXd free = -cholesky.solve(gradient);
  const auto whitened = [&](const Eigen::MatrixXd& a) {
    return Eigen::MatrixXd(cholesky.matrixL().solve(a.transpose()).transpose());
  };
  const Eigen::MatrixXd rows = whitened(program.A);
  std::vector<bool> is_equality(static_cast<std::size_t>(program.rowCount()), false);
  for (const int row : program.equalities) is_equality.at(static_cast<std::size_t>(row)) = true;
  SideCollector collector(tables);
  for (Eigen::Index i = 0; i < program.rowCount(); ++i) {
    Row bound(p + 1);
    bound << program.S.row(i), program.b(i);
    const Row limit = bound - program.A.row(i) * free;
    const double squared = rows.row(i).squaredNorm();
    // An equality is a side in each direction.
    const int directions = is_equality[static_cast<std::size_t>(i)] ? 2 : 1;
    for (int direction = 0; direction < directions; ++direction) {
      const double sign = direction == 0 ? 1.0 : -1.0;
      if (program.A.row(i).squaredNorm() == 0.0 ||
          squared <= kNoRow * program.A.row(i).squaredNorm() / program.H.norm()) {
        append(tables.conditions, condition(program, sign * bound));
      } else {
        collector.add(sign / std::sqrt(squared) * rows.row(i), sign / std::sqrt(squared) * limit, i);
      }
    }
  }
  collector.finish();
  if (tables.sides.empty())
    throw Error(program.name + ": A: no row bounds the variables, so u is K theta + k");

  Eigen::MatrixXd constant(program.inputCount(), p + 1);
  constant << program.C, program.c;
  const Eigen::MatrixXd law = program.E * free + constant;
  const Eigen::MatrixXd effect = whitened(program.E);
  for (Eigen::Index j = 0; j < law.rows(); ++j) {
    append(tables.law, law.row(j));
    append(tables.effect, effect.row(j));
  }
  return tables;
}

}  // namespace polyfly
