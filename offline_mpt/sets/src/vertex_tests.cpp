#include "vertex_tests.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

Rational powerOfTwoNear(const Rational& value) {
  const Integer &numerator = value.get_num(), &denominator = value.get_den();
  Rational result(1);
  if (value == 0) return result;
  mpq_mul_2exp(result.get_mpq_t(), result.get_mpq_t(), mpz_sizeinbase(numerator.get_mpz_t(), 2));
  mpq_div_2exp(result.get_mpq_t(), result.get_mpq_t(), mpz_sizeinbase(denominator.get_mpz_t(), 2));
  return result;
}

}  // namespace

double roundedUp(const Rational& value) {
  return value == 0 ? 0.0 : std::nextafter(value.get_d(), std::numeric_limits<double>::infinity());
}

Rational worst(const std::vector<std::vector<Integer>>& vertices, const RationalVector& a, const Rational& b,
               const std::vector<Integer>** where) {
  const std::vector<Integer> row = coneRow({a, b});
  Rational greatest;
  for (const std::vector<Integer>& vertex : vertices) {
    if (dot(row, vertex) >= 0) continue;
    const Rational excess = dot(a, pointOf(vertex)) - b;
    if (excess <= greatest) continue;
    greatest = excess;
    *where = &vertex;
  }
  return greatest;
}

RationalVector middleOf(const std::vector<std::vector<Integer>>& corners) {
  RationalVector middle(corners[0].size() - 1);
  const Rational share(1, static_cast<unsigned long>(corners.size()));
  for (const std::vector<Integer>& corner : corners) {
    const RationalVector point = pointOf(corner);
    for (std::size_t j = 0; j < middle.size(); ++j) middle[j] += share * point[j];
  }
  return middle;
}

std::vector<ExactHalfSpace> scaledRows(const ExactPolytope& set, const RegionMap& map) {
  std::vector<ExactHalfSpace> rows;
  const auto add = [&](const ExactHalfSpace& row, int sign) {
    RationalVector steps;  // per half a range
    Rational greatest;
    for (std::size_t j = 0; j < row.a.size(); ++j) {
      const Signal& parameter = map.parameters()[j];
      steps.push_back(row.a[j] * (Rational(parameter.upper) - Rational(parameter.lower)) / 2);
      if (abs(steps.back()) > greatest) greatest = abs(steps.back());
    }
    // Relative to a power of two near the greatest, so that no square overflows or vanishes.
    const Rational unit = powerOfTwoNear(greatest);
    double squares = 0.0;
    for (const Rational& step : steps) squares += std::pow(Rational(step / unit).get_d(), 2);
    const Rational scale = Rational(squares > 0.0 ? sign / std::sqrt(squares) : sign) / unit;
    ExactHalfSpace scaled{row.a, Rational(row.b * scale)};
    for (Rational& value : scaled.a) value *= scale;
    rows.push_back(std::move(scaled));
  };
  const ExactPolytope smallest = minimal(set);
  for (const ExactHalfSpace& row : smallest.rows) add(row, 1);
  for (const ExactHalfSpace& row : smallest.equalities) {
    add(row, 1);
    add(row, -1);
  }
  return rows;
}

}  // namespace polyfly
