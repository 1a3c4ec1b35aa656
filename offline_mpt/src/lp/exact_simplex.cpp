#include "lp/exact_simplex.hpp"

#include <algorithm>
#include <cmath>

namespace polyfly {
namespace {

constexpr int kFreeChoice = 60;  // pivots with the most violated row; then the first, which cannot cycle

Rational fraction(const Integer& numerator, const Integer& denominator) {
  Rational result(numerator, denominator);
  result.canonicalize();
  return result;
}

}  // namespace

std::vector<Integer> ExactSimplex::coefficients(int row) const {
  if (row < count()) return rows_[static_cast<std::size_t>(row)];
  std::vector<Integer> side(static_cast<std::size_t>(dimension_) + 1);
  side[static_cast<std::size_t>((row - count()) / 2)] = (row - count()) % 2 == 0 ? 1 : -1;
  side.back() = 1;
  return side;
}

bool ExactSimplex::startFrom(const std::vector<int>& basis, const std::vector<Integer>& c) {
  if (static_cast<int>(basis.size()) != dimension_) return false;
  IntegerMatrix system(dimension_, 2 * dimension_);
  for (int k = 0; k < dimension_; ++k) {
    const std::vector<Integer> row = coefficients(basis[static_cast<std::size_t>(k)]);
    for (int j = 0; j < dimension_; ++j) system(k, j) = row[static_cast<std::size_t>(j)];
    system(k, dimension_ + k) = 1;
  }
  if (!solveExactly(system, determinant_)) return false;
  for (int i = 0; i < dimension_; ++i) {
    for (int k = 0; k < dimension_; ++k) inverse_(i, k) = system(i, dimension_ + k);
  }
  basis_ = basis;
  const std::vector<Integer> weights = inBasis(c);
  return std::all_of(weights.begin(), weights.end(), [](const Integer& weight) { return weight >= 0; });
}

void ExactSimplex::startAtCorner(const std::vector<Integer>& c) {
  basis_.clear();
  determinant_ = 1;
  for (int j = 0; j < dimension_; ++j) {
    const bool upper = c[static_cast<std::size_t>(j)] >= 0;
    basis_.push_back(count() + 2 * j + (upper ? 0 : 1));
    for (int k = 0; k < dimension_; ++k) inverse_(j, k) = j != k ? 0 : upper ? 1 : -1;
  }
}

// The weights of the basis, times the determinant, that combine it to `a`.
std::vector<Integer> ExactSimplex::inBasis(const std::vector<Integer>& a) const {
  std::vector<Integer> result(static_cast<std::size_t>(dimension_));
  for (int i = 0; i < dimension_; ++i) {
    const Integer& factor = a[static_cast<std::size_t>(i)];
    if (factor == 0) continue;
    for (int k = 0; k < dimension_; ++k)
      mpz_addmul(result[static_cast<std::size_t>(k)].get_mpz_t(), factor.get_mpz_t(),
                 inverse_(i, k).get_mpz_t());
  }
  return result;
}

void ExactSimplex::findPoint() {
  point_.assign(static_cast<std::size_t>(dimension_), Integer(0));
  for (int k = 0; k < dimension_; ++k) {
    const Integer bound = coefficients(basis_[static_cast<std::size_t>(k)]).back();
    for (int i = 0; i < dimension_; ++i)
      mpz_addmul(point_[static_cast<std::size_t>(i)].get_mpz_t(), bound.get_mpz_t(),
                 inverse_(i, k).get_mpz_t());
  }
}

// a . x - b, times the determinant.
Integer ExactSimplex::excess(int row) const {
  if (row >= count()) {
    const Integer& x = point_[static_cast<std::size_t>((row - count()) / 2)];
    return (row - count()) % 2 == 0 ? Integer(x - determinant_) : Integer(-x - determinant_);
  }
  const std::vector<Integer>& a_b = rows_[static_cast<std::size_t>(row)];
  Integer sum = -a_b.back() * determinant_;
  for (std::size_t j = 0; j < point_.size(); ++j)
    mpz_addmul(sum.get_mpz_t(), a_b[j].get_mpz_t(), point_[j].get_mpz_t());
  return sum;
}

// The first violated row, or about the most violated one; -1 where there is none.
int ExactSimplex::violated(bool first) const {
  int found = -1;
  double most = 0.0;
  for (int row = 0; row < count() + 2 * dimension_; ++row) {
    const Integer value = excess(row);
    if (value <= 0) continue;
    if (first) return row;
    long size = 1, unit = 0;
    double mantissa = mpz_get_d_2exp(&size, value.get_mpz_t());
    if (row < count()) {
      for (std::size_t j = 0; j < point_.size(); ++j)
        unit = std::max(
            unit, static_cast<long>(mpz_sizeinbase(rows_[static_cast<std::size_t>(row)][j].get_mpz_t(), 2)));
    }
    const double violation = std::log2(mantissa) + static_cast<double>(size - unit);
    if (found >= 0 && violation <= most) continue;
    most = violation;
    found = row;
  }
  return found;
}

// Whose weight vanishes first, of equals the one of least index; -1 where none does.
int ExactSimplex::leaving(const std::vector<Integer>& share, const std::vector<Integer>& weights) const {
  int best = -1;
  for (int k = 0; k < dimension_; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (share[at] <= 0) continue;
    if (best >= 0) {
      const auto other = static_cast<std::size_t>(best);
      const int order = cmp(weights[at] * share[other], weights[other] * share[at]);
      if (order > 0 || (order == 0 && basis_[at] > basis_[other])) continue;
    }
    best = k;
  }
  return best;
}

void ExactSimplex::replace(int place, int row, const std::vector<Integer>& share) {
  const Integer& pivot = share[static_cast<std::size_t>(place)];
  Integer work;
  for (int k = 0; k < dimension_; ++k) {
    if (k == place) continue;
    for (int i = 0; i < dimension_; ++i) {
      Integer& entry = inverse_(i, k);
      mpz_mul(work.get_mpz_t(), inverse_(i, place).get_mpz_t(),
              share[static_cast<std::size_t>(k)].get_mpz_t());
      entry *= pivot;
      entry -= work;
      mpz_divexact(entry.get_mpz_t(), entry.get_mpz_t(), determinant_.get_mpz_t());
    }
  }
  determinant_ = pivot;
  basis_[static_cast<std::size_t>(place)] = row;
}

ExactSimplex::Status ExactSimplex::maximise(const std::vector<Integer>& c, const std::vector<int>& start) {
  c_ = c;
  weights_.clear();
  if (!startFrom(start, c)) startAtCorner(c);
  for (int round = 0;; ++round) {
    findPoint();
    const std::vector<Integer> weights = inBasis(c);
    const int row = violated(round >= kFreeChoice);
    if (row < 0) {
      for (std::size_t k = 0; k < weights.size(); ++k) {
        if (weights[k] > 0) weights_.emplace_back(basis_[k], fraction(weights[k], determinant_));
      }
      return Status::kOptimal;
    }
    const std::vector<Integer> share = inBasis(coefficients(row));
    const int place = leaving(share, weights);
    if (place < 0) {
      weights_.emplace_back(row, Rational(1));
      for (std::size_t k = 0; k < share.size(); ++k) {
        if (share[k] < 0) weights_.emplace_back(basis_[k], fraction(-share[k], determinant_));
      }
      return Status::kInfeasible;
    }
    replace(place, row, share);
  }
}

std::vector<Rational> ExactSimplex::x() const {
  std::vector<Rational> result;
  for (const Integer& value : point_) result.push_back(fraction(value, determinant_));
  return result;
}

Rational ExactSimplex::objective() const {
  Integer sum;
  for (std::size_t j = 0; j < point_.size(); ++j) sum += c_[j] * point_[j];
  return fraction(sum, determinant_);
}

}  // namespace polyfly
