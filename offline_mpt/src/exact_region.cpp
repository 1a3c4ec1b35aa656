#include "exact_region.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

/// The optimality conditions with one right-hand side for each parameter and the constant; a linear program
/// has a second group, for prices.
IntegerMatrix optimalitySystem(const ExactProgram& program, const std::vector<int>& rows) {
  const int n = program.n;
  const int k = static_cast<int>(rows.size());
  const int width = program.p + 1;
  IntegerMatrix system(n + k, n + k + (program.linear ? 2 : 1) * width);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) system(i, j) = program.H(i, j);
    for (int r = 0; r < k; ++r) system(i, n + r) = system(n + r, i) = program.A(rows[r], i);
    for (int j = 0; j < width; ++j) system(i, n + k + (program.linear ? width : 0) + j) = -program.cost(i, j);
  }
  for (int r = 0; r < k; ++r) {
    for (int j = 0; j < width; ++j) system(n + r, n + k + j) = program.bound(rows[r], j);
  }
  return system;
}

/// One solved system: unknown i as p + 1 whole numbers over the determinant.
struct Solution {
  const IntegerMatrix& system;
  Integer determinant;
  int first;  ///< column

  const Integer& at(int unknown, int j) const { return system(unknown, first + j); }
};

bool isZero(const std::vector<Integer>& row) {
  return std::all_of(row.begin(), row.end(), [](const Integer& value) { return value == 0; });
}

ExactRow makeRow(ExactOrigin origin, std::vector<Integer> value) {
  ExactRow row{origin, std::move(value), {}, 0, 0.0};
  finishRow(row);
  return row;
}

std::vector<Integer> slackOf(const ExactProgram& program, const Solution& z, int row) {
  std::vector<Integer> slack;
  for (int j = 0; j <= program.p; ++j) {
    Integer value = z.determinant * program.bound(row, j);
    for (int i = 0; i < program.n; ++i) {
      if (program.A(row, i) != 0)
        mpz_submul(value.get_mpz_t(), program.A(row, i).get_mpz_t(), z.at(i, j).get_mpz_t());
    }
    slack.push_back(std::move(value));
  }
  return slack;
}

// slack + determinant 2^shift 2^-kDroppedBits size >= 0
std::vector<Integer> relax(const ExactProgram& program, std::vector<Integer> slack,
                           const Integer& determinant, int row) {
  for (Integer& value : slack) value <<= kDroppedBits;
  slack.back() += (determinant * program.row_size[row]) << static_cast<unsigned long>(program.shift);
  return slack;
}

bool addSlacks(const ExactProgram& program, const Solution& z, const std::vector<char>& is_used,
               ExactRegion& region) {
  for (int i = 0; i < program.m; ++i) {
    if (is_used[i]) continue;
    std::vector<Integer> slack = slackOf(program, z, i);
    if (program.is_equality[i]) {
      if (!isZero(slack)) return false;
    } else if (program.is_dropped[i]) {
      slack = relax(program, std::move(slack), z.determinant, i);
      region.dropped.push_back(makeRow({ExactOrigin::Kind::kSlack, i}, std::move(slack)));
    } else {
      region.rows.push_back(makeRow({ExactOrigin::Kind::kSlack, i}, std::move(slack)));
    }
  }
  return true;
}

void setLaw(const ExactProgram& program, const Solution& z, ExactRegion& region) {
  Rational inverse(Integer(1), z.determinant << static_cast<unsigned long>(program.shift));
  region.law = program.offset;
  for (int i = 0; i < program.q; ++i) {
    for (int j = 0; j <= program.p; ++j) {
      Rational sum;
      for (int k = 0; k < program.n; ++k) {
        const Rational& weight = program.E[static_cast<std::size_t>(i) * program.n + k];
        if (weight != 0) sum += weight * z.at(k, j);
      }
      region.law[static_cast<std::size_t>(i) * (program.p + 1) + j] += sum * inverse;
    }
  }
}

}  // namespace

void finishRow(ExactRow& row) {
  Integer divisor(0);
  for (const Integer& value : row.value) divisor = gcd(divisor, value);
  if (divisor > 1) {
    for (Integer& value : row.value) mpz_divexact(value.get_mpz_t(), value.get_mpz_t(), divisor.get_mpz_t());
  }
  row.bits = 0;
  for (const Integer& value : row.value) {
    if (value != 0) row.bits = std::max(row.bits, mpz_sizeinbase(value.get_mpz_t(), 2));
  }
  const std::size_t p = row.value.size() - 1;
  row.unit.assign(p + 1, 0.0);
  double squared = 0.0;
  for (std::size_t j = 0; j <= p; ++j) {
    signed long exponent = 0;
    const double mantissa = mpz_get_d_2exp(&exponent, row.value[j].get_mpz_t());
    row.unit[j] = std::ldexp(mantissa, static_cast<int>(exponent - static_cast<long>(row.bits)));
    if (j == p) break;
    row.unit[j] = -row.unit[j];
    squared += row.unit[j] * row.unit[j];
  }
  row.length = std::sqrt(squared);
  if (squared == 0.0) return;
  const double inverse = 1.0 / row.length;
  for (double& value : row.unit) value *= inverse;
}

std::vector<const ExactRow*> rowsThatCanFail(const ExactRegion& region) {
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

ExactStatus describeExactly(const ExactProgram& program, const std::vector<int>& active,
                            ExactRegion& region) {
  region = {};
  std::vector<int> rows = program.basis;
  std::vector<char> is_used(static_cast<std::size_t>(program.m), 0);
  for (const int row : program.basis) is_used[row] = 1;
  for (const int row : active) {
    if (is_used[row]) continue;
    is_used[row] = 1;
    rows.push_back(row);
    region.active.push_back(row);
  }
  std::sort(region.active.begin(), region.active.end());
  if (static_cast<int>(rows.size()) > program.n) return ExactStatus::kDependent;
  IntegerMatrix system = optimalitySystem(program, rows);
  const int unknowns = system.rows();
  Solution z{system, 0, unknowns};
  if (!solveExactly(system, z.determinant)) return ExactStatus::kDependent;
  const Solution prices{system, z.determinant, unknowns + program.p + 1};
  if (program.linear) {
    for (int i = 0; i < program.n; ++i) {
      for (int j = 0; j <= program.p; ++j) {
        if (prices.at(i, j) != 0) return ExactStatus::kUnpaid;
      }
    }
  }
  for (std::size_t r = program.basis.size(); r < rows.size(); ++r) {
    const int unknown = program.n + static_cast<int>(r);
    std::vector<Integer> multiplier, price;
    for (int j = 0; j <= program.p; ++j) {
      multiplier.push_back(z.at(unknown, j));
      if (program.linear) price.push_back(prices.at(unknown, j));
    }
    const bool priced = program.linear && !isZero(price);
    region.rows.push_back(
        makeRow({priced ? ExactOrigin::Kind::kPrice : ExactOrigin::Kind::kMultiplier, rows[r]},
                priced ? std::move(price) : std::move(multiplier)));
  }
  if (!addSlacks(program, z, is_used, region)) return ExactStatus::kInconsistent;
  for (int i = 0; i < program.domain.rows(); ++i) {
    std::vector<Integer> value;
    for (int j = 0; j <= program.p; ++j) value.push_back(program.domain(i, j));
    region.rows.push_back(makeRow({ExactOrigin::Kind::kDomain, i}, std::move(value)));
  }
  setLaw(program, z, region);
  return ExactStatus::kRegion;
}

}  // namespace polyfly
