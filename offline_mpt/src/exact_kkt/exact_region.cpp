#include "exact_kkt/exact_region.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace polyfly {
namespace {

/// The optimality conditions with one right-hand side for each parameter and the constant; a linear program
/// has a second group, for cost multipliers.
IntegerMatrix optimalitySystem(const ExactProgram& program, const std::vector<int>& rows) {
  const int n = program.n;
  const int k = static_cast<int>(rows.size());
  const int width = program.p + 1;
  IntegerMatrix system = optimalityMatrix(program, rows, (program.linear ? 2 : 1) * width);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < width; ++j) system(i, n + k + (program.linear ? width : 0) + j) = -program.cost(i, j);
  }
  for (int r = 0; r < k; ++r) {
    for (int j = 0; j < width; ++j) system(n + r, n + k + j) = program.bound(rows[r], j);
  }
  return system;
}

bool isZero(const std::vector<Integer>& row) {
  return std::all_of(row.begin(), row.end(), [](const Integer& value) { return value == 0; });
}

ExactRow makeRow(ExactOrigin origin, std::vector<Integer> value) {
  ExactRow row{origin, std::move(value), {}, 0, 0.0};
  finishRow(row);
  return row;
}

// slack + determinant 2^shift 2^-bits size >= 0
std::vector<Integer> relax(const ExactProgram& program, std::vector<Integer> slack,
                           const Integer& determinant, int row, int bits) {
  for (Integer& value : slack) value <<= static_cast<unsigned long>(bits);
  slack.back() += (determinant * program.row_size[row]) << static_cast<unsigned long>(program.shift);
  return slack;
}

bool addSlacks(const ExactProgram& program, const ExactSolution& solution, const std::vector<char>& is_used,
               ExactRegion& region) {
  for (int i = 0; i < program.m; ++i) {
    if (is_used[i]) continue;
    std::vector<Integer> slack = solution.slack(program, i);
    if (program.is_equality[i] && program.is_dropped[i]) {
      std::vector<Integer> excess;
      for (const Integer& value : slack) excess.push_back(-value);
      const Integer& determinant = solution.denominator();
      slack = relax(program, std::move(slack), determinant, i, kForgivenBits);
      excess = relax(program, std::move(excess), determinant, i, kForgivenBits);
      region.dropped.push_back(makeRow({ExactOrigin::Kind::kSlack, i}, std::move(slack)));
      region.dropped.push_back(makeRow({ExactOrigin::Kind::kExcess, i}, std::move(excess)));
    } else if (program.is_equality[i]) {
      if (!isZero(slack)) return false;
    } else if (program.is_dropped[i]) {
      slack = relax(program, std::move(slack), solution.denominator(), i, kDroppedBits);
      region.dropped.push_back(makeRow({ExactOrigin::Kind::kSlack, i}, std::move(slack)));
    } else {
      if (program.forgiving)
        region.forgiven.push_back(makeRow({ExactOrigin::Kind::kSlack, i},
                                          relax(program, slack, solution.denominator(), i, kForgivenBits)));
      region.rows.push_back(makeRow({ExactOrigin::Kind::kSlack, i}, std::move(slack)));
    }
  }
  return true;
}

}  // namespace

IntegerMatrix optimalityMatrix(const ExactProgram& program, const std::vector<int>& rows, int sides) {
  const int n = program.n, size = n + static_cast<int>(rows.size());
  IntegerMatrix system(size, size + sides);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) system(i, j) = program.H(i, j);
    for (int r = n; r < size; ++r)
      system(i, r) = system(r, i) = program.A(rows[static_cast<std::size_t>(r - n)], i);
  }
  return system;
}

void finishRow(ExactRow& row) {
  Integer divisor(0);
  for (const Integer& value : row.value) divisor = gcd(divisor, value);
  if (divisor > 1) {
    for (Integer& value : row.value) mpz_divexact(value.get_mpz_t(), value.get_mpz_t(), divisor.get_mpz_t());
  }
  const std::size_t p = row.value.size() - 1;
  const auto bits_of = [](const Integer& value) {
    return value == 0 ? std::size_t{0} : mpz_sizeinbase(value.get_mpz_t(), 2);
  };
  std::size_t gradient_bits = 0;
  for (std::size_t j = 0; j < p; ++j) gradient_bits = std::max(gradient_bits, bits_of(row.value[j]));
  row.bits = std::max(gradient_bits, bits_of(row.value[p]));
  // Relative to the gradient, which a far greater constant would let vanish.
  const auto reference = static_cast<long>(gradient_bits > 0 ? gradient_bits : row.bits);
  row.unit.assign(p + 1, 0.0);
  double squared = 0.0;
  for (std::size_t j = 0; j <= p; ++j) {
    signed long exponent = 0;
    const double mantissa = mpz_get_d_2exp(&exponent, row.value[j].get_mpz_t());
    row.unit[j] = std::ldexp(mantissa, static_cast<int>(exponent - reference));
    if (j == p) break;
    row.unit[j] = -row.unit[j];
    squared += row.unit[j] * row.unit[j];
  }
  row.length = 0.0;
  if (gradient_bits == 0) return;
  const double inverse = 1.0 / std::sqrt(squared);
  for (double& value : row.unit) value *= inverse;
  const int shift = static_cast<int>(reference - static_cast<long>(row.bits));
  row.length = std::max(std::ldexp(std::sqrt(squared), shift), std::numeric_limits<double>::min());
}

std::vector<const ExactRow*> nontrivialRows(const ExactRegion& region) {
  std::vector<const ExactRow*> rows;
  for (const ExactRow& row : region.rows) {
    const bool constant =
        std::all_of(row.value.begin(), row.value.end() - 1, [](const Integer& value) { return value == 0; });
    if (!constant || row.value.back() < 0) rows.push_back(&row);
  }
  return rows;
}

ExactRow boxRow(int p, int index) {
  std::vector<Integer> value(static_cast<std::size_t>(p) + 1);
  value[static_cast<std::size_t>(index / 2)] = index % 2 == 0 ? -1 : 1;
  value.back() = 1;
  return makeRow({ExactOrigin::Kind::kBox, index}, std::move(value));
}

std::vector<std::vector<Integer>> halfSpaces(const std::vector<const ExactRow*>& rows) {
  std::vector<std::vector<Integer>> result;
  for (const ExactRow* row : rows) {
    result.push_back(row->value);
    for (auto value = result.back().begin(); value + 1 != result.back().end(); ++value) *value = -*value;
  }
  return result;
}

ExactRow opposite(ExactRow row) {
  for (Integer& value : row.value) value = -value;
  finishRow(row);
  return row;
}

bool sameHalfSpace(const ExactRow& row, const ExactRow& other) {
  std::size_t k = 0;
  while (k + 1 < other.value.size() && other.value[k] == 0) ++k;
  if (sgn(row.value[k]) != sgn(other.value[k]) || other.value[k] == 0) return false;
  Integer left, right;
  for (std::size_t j = 0; j < row.value.size(); ++j) {
    mpz_mul(left.get_mpz_t(), row.value[j].get_mpz_t(), other.value[k].get_mpz_t());
    mpz_mul(right.get_mpz_t(), other.value[j].get_mpz_t(), row.value[k].get_mpz_t());
    if (left != right) return false;
  }
  return true;
}

Integer valueAt(const ExactRow& row, const std::vector<Rational>& t) {
  Rational sum(row.value.back());
  for (std::size_t j = 0; j < t.size(); ++j) sum += row.value[j] * t[j];
  return sum.get_num();
}

ExactStatus ExactSolution::solve(const ExactProgram& program, const std::vector<int>& active) {
  rows_ = program.basis;
  for (const int row : active) {
    if (!program.in_basis[row]) rows_.push_back(row);
  }
  if (static_cast<int>(rows_.size()) > program.n) return ExactStatus::kDependent;
  n_ = program.n;
  width_ = program.p + 1;
  system_ = optimalitySystem(program, rows_);
  first_ = system_.rows();
  cost_column_ = first_ + width_;
  if (!solveExactly(system_, determinant_)) return ExactStatus::kDependent;
  if (!program.linear) return ExactStatus::kRegion;
  for (int i = 0; i < n_; ++i) {
    for (int j = 0; j < width_; ++j) {
      if (system_(i, first_ + width_ + j) != 0) return ExactStatus::kCostNotSpanned;
    }
  }
  return ExactStatus::kRegion;
}

std::vector<Integer> ExactSolution::slack(const ExactProgram& program, int row) const {
  std::vector<Integer> slack;
  for (int j = 0; j < width_; ++j) {
    Integer value = determinant_ * program.bound(row, j);
    for (int i = 0; i < n_; ++i) {
      if (program.A(row, i) != 0)
        mpz_submul(value.get_mpz_t(), program.A(row, i).get_mpz_t(), z(i, j).get_mpz_t());
    }
    slack.push_back(std::move(value));
  }
  return slack;
}

std::vector<Rational> ExactSolution::law(const ExactProgram& program) const {
  const Rational inverse(Integer(1), determinant_ << static_cast<unsigned long>(program.shift));
  std::vector<Rational> law = program.offset;
  for (int i = 0; i < program.q; ++i) {
    for (int j = 0; j < width_; ++j) {
      Rational sum;
      for (int k = 0; k < n_; ++k) {
        const Rational& weight = program.E[static_cast<std::size_t>(i) * n_ + k];
        if (weight != 0) sum += weight * z(k, j);
      }
      law[static_cast<std::size_t>(i) * width_ + j] += sum * inverse;
    }
  }
  return law;
}

ExactStatus describeExactly(const ExactProgram& program, const std::vector<int>& active,
                            ExactRegion& region) {
  region = {};
  ExactSolution solution;
  const ExactStatus status = solution.solve(program, active);
  const std::vector<int>& rows = solution.rows();
  region.active.assign(rows.begin() + static_cast<std::ptrdiff_t>(program.basis.size()), rows.end());
  std::sort(region.active.begin(), region.active.end());
  if (status != ExactStatus::kRegion) return status;
  std::vector<char> is_used(static_cast<std::size_t>(program.m), 0);
  for (const int row : rows) is_used[row] = 1;
  for (std::size_t k = program.basis.size(); k < rows.size(); ++k) {
    const int r = static_cast<int>(k);
    std::vector<Integer> multiplier, cost_multiplier;
    for (int j = 0; j <= program.p; ++j) {
      multiplier.push_back(solution.multiplier(r, j));
      if (program.linear) cost_multiplier.push_back(solution.costMultiplier(r, j));
    }
    const bool by_cost = program.linear && !isZero(cost_multiplier);
    region.rows.push_back(
        makeRow({by_cost ? ExactOrigin::Kind::kCostMultiplier : ExactOrigin::Kind::kMultiplier, rows[k]},
                by_cost ? std::move(cost_multiplier) : std::move(multiplier)));
  }
  if (!addSlacks(program, solution, is_used, region)) return ExactStatus::kInconsistent;
  for (int i = 0; i < program.domain.rows(); ++i) {
    std::vector<Integer> value;
    for (int j = 0; j <= program.p; ++j) value.push_back(program.domain(i, j));
    region.rows.push_back(makeRow({ExactOrigin::Kind::kDomain, i}, std::move(value)));
  }
  region.law = solution.law(program);
  return ExactStatus::kRegion;
}

}  // namespace polyfly
