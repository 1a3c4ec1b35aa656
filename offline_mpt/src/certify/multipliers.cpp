#include "certify/multipliers.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "certify/tolerances.hpp"

namespace polyfly {
std::size_t mostBits(const ExactRows& rows, const ExactRow* other) {
  std::size_t bits = other != nullptr ? other->bits : 0;
  for (const ExactRow* row : rows) bits = std::max(bits, row->bits);
  return bits;
}

void subtract(std::vector<Integer>& sum, const Integer& weight, const ExactRow& row, std::size_t shift) {
  const Integer factor = weight << static_cast<unsigned long>(shift);
  for (std::size_t j = 0; j < sum.size(); ++j)
    mpz_submul(sum[j].get_mpz_t(), factor.get_mpz_t(), row.value[j].get_mpz_t());
}

Integer least(const std::vector<Integer>& affine) {
  Integer value = affine.back();
  for (std::size_t j = 0; j + 1 < affine.size(); ++j) value -= abs(affine[j]);
  return value;
}

// The power of two is applied to whole numbers: in a double, that of a long row overflows.
Integer toInteger(double value, long exponent) {
  int own = 0;
  const double mantissa = std::ldexp(std::frexp(value, &own), std::numeric_limits<double>::digits);
  const long shift = exponent + own - std::numeric_limits<double>::digits;
  Integer result(mantissa);
  if (shift >= 0) return result << static_cast<unsigned long>(shift);
  mpz_tdiv_q_2exp(result.get_mpz_t(), result.get_mpz_t(), static_cast<mp_bitcnt_t>(-shift));
  return result;
}

FarkasProof roundWeights(const std::vector<std::pair<int, double>>& weights, const ExactRows& rows,
                         double target_length, int bits) {
  double greatest = 0.0;
  std::vector<std::pair<int, double>> scaled;
  for (const auto& [row, weight] : weights) {
    if (row >= static_cast<int>(rows.size())) continue;
    scaled.emplace_back(row, weight * target_length / rows[static_cast<std::size_t>(row)]->length);
    if (!std::isfinite(scaled.back().second)) return {};
    greatest = std::max(greatest, scaled.back().second);
  }
  FarkasProof proof;
  if (!(greatest > 0.0)) return proof;
  const int exponent = std::max(0, bits - std::ilogb(greatest));
  proof.scale <<= static_cast<unsigned long>(exponent);
  for (const auto& [row, weight] : scaled) {
    const Integer whole = toInteger(weight, exponent);
    if (whole > 0) proof.weights.emplace_back(row, whole);
  }
  return proof;
}

// NOLINTNEXTLINE(performance-unnecessary-value-param): the first loop changes the weights.
FarkasProof clearFractions(std::vector<std::pair<int, Rational>> weights, const ExactRows& rows,
                           std::size_t bits, std::size_t target_bits) {
  Integer denominator(1);
  for (auto& [row, weight] : weights) {
    const std::size_t own = row < static_cast<int>(rows.size()) ? rows[row]->bits : target_bits;
    weight *= Rational(Integer(1) << (bits - target_bits), Integer(1) << (bits - own));
    weight.canonicalize();
    denominator = lcm(denominator, weight.get_den());
  }
  FarkasProof proof;
  proof.scale = denominator;
  for (const auto& [row, weight] : weights)
    proof.weights.emplace_back(row, Integer(weight.get_num() * (denominator / weight.get_den())));
  return proof;
}

bool combineExactly(const ExactRows& rows, const ExactRow& target, const std::vector<char>& skip,
                    std::vector<Rational>& weights) {
  const int unknowns = static_cast<int>(rows.size());
  std::vector<int> coordinates;
  for (std::size_t j = 0; j + 1 < target.value.size(); ++j) {
    if (!skip[j]) coordinates.push_back(static_cast<int>(j));
  }
  IntegerMatrix equations(static_cast<int>(coordinates.size()), unknowns);
  for (int e = 0; e < equations.rows(); ++e) {
    for (int k = 0; k < unknowns; ++k)
      equations(e, k) = rows[static_cast<std::size_t>(k)]->value[static_cast<std::size_t>(coordinates[e])];
  }
  const std::vector<int> kept = independentRows(equations);
  if (static_cast<int>(kept.size()) != unknowns) return false;
  IntegerMatrix system(unknowns, unknowns + 1);
  for (int e = 0; e < unknowns; ++e) {
    for (int k = 0; k < unknowns; ++k) system(e, k) = equations(kept[static_cast<std::size_t>(e)], k);
    system(e, unknowns) = target.value[static_cast<std::size_t>(
        coordinates[static_cast<std::size_t>(kept[static_cast<std::size_t>(e)])])];
  }
  Integer determinant;
  if (!solveExactly(system, determinant)) return false;
  weights.clear();
  for (int k = 0; k < unknowns; ++k) {
    weights.emplace_back(system(k, unknowns), determinant);
    weights.back().canonicalize();
  }
  return true;
}

ExactRows rowsOfWeights(const std::vector<std::pair<int, double>>& weights, const ExactRows& rows,
                        int first_box, std::vector<char>& skip, std::vector<int>& places) {
  double greatest = 0.0;
  for (const auto& [row, weight] : weights) greatest = std::max(greatest, weight);
  ExactRows chosen;
  for (const auto& [row, weight] : weights) {
    if (weight <= tolerance::kNoWeight * greatest) continue;
    if (row < static_cast<int>(rows.size())) {
      chosen.push_back(rows[static_cast<std::size_t>(row)]);
      places.push_back(row);
    } else if (row >= first_box && static_cast<std::size_t>(row - first_box) / 2 < skip.size()) {
      skip[static_cast<std::size_t>(row - first_box) / 2] = 1;
    }
  }
  return chosen;
}

}  // namespace polyfly
