#include "core/rows.hpp"

#include <cstdlib>

namespace checker {

Row primitive(const Vector& values) {
  Integer denominator(1), divisor(0);
  for (const Fraction& value : values) denominator = lcm(denominator, value.get_den());
  Row row;
  for (const Fraction& value : values) {
    row.push_back(value.get_num() * (denominator / value.get_den()));
    divisor = gcd(divisor, row.back());
  }
  if (divisor > 1) {
    for (Integer& value : row) value /= divisor;
  }
  return row;
}

Row primitive(const Row& values) { return primitive(Vector(values.begin(), values.end())); }

Row negated(const Row& row) {
  Row result = row;
  for (Integer& value : result) value = -value;
  return result;
}

namespace {

/// The first entry that is not zero.
std::size_t leading(const Row& row) {
  const auto at = std::find_if(row.begin(), row.end(), [](const Integer& value) { return value != 0; });
  require(at != row.end(), "a half-space is no half-space: all its entries are zero");
  return static_cast<std::size_t>(at - row.begin());
}

}  // namespace

bool proportional(const Row& a, const Row& b) {
  const std::size_t k = leading(b);
  for (std::size_t j = 0; j < a.size(); ++j) {
    if (a[j] * b[k] != b[j] * a[k]) return false;
  }
  return true;
}

bool sameHalfSpace(const Row& a, const Row& b) {
  const std::size_t k = leading(b);
  return proportional(a, b) && sgn(a[k]) == sgn(b[k]);
}

Integer leastInBox(const Row& row) {
  Integer value = row.back();
  for (std::size_t j = 0; j + 1 < row.size(); ++j) value -= abs(row[j]);
  return value;
}

int bitsOf(const Row& row) {
  std::size_t most = 0;
  for (const Integer& value : row)
    most = std::max(most, value == 0 ? 0 : mpz_sizeinbase(value.get_mpz_t(), 2));
  return static_cast<int>(most);
}

Row remainder(const Row* target, const Integer& scale, const Weights& weights,
              const std::vector<const Row*>& rows) {
  int most = target != nullptr ? bitsOf(*target) : 0;
  for (const auto& [place, weight] : weights) {
    require(place < rows.size() && rows[place] != nullptr, "a proof names a row that is not there");
    most = std::max(most, bitsOf(*rows[place]));
  }
  Row rest;
  const auto add = [&](const Row& row, const Integer& factor) {
    rest.resize(row.size());
    for (std::size_t j = 0; j < row.size(); ++j)
      rest[j] += factor * (row[j] << static_cast<unsigned long>(most - bitsOf(row)));
  };
  if (target != nullptr) add(*target, scale);
  for (const auto& [place, weight] : weights) add(*rows[place], -weight);
  return rest;
}

Weights readWeights(Line& line) {
  Weights weights;
  for (std::size_t k = line.count(kMany); k > 0; --k) {
    const std::size_t place = line.count(kMany);
    weights.emplace_back(place, line.integer());
  }
  return weights;
}

void requireEmpty(Line& line, const std::vector<const Row*>& rows, const Row* plane) {
  std::vector<const Row*> with_plane = rows;
  if (plane != nullptr) with_plane.push_back(plane);
  const Weights weights = readWeights(line);
  require(!weights.empty(), "an empty proof");
  bool counts = false;
  for (const auto& [place, weight] : weights) {
    require(weight >= 0 || (plane != nullptr && place == rows.size()), "a proof has a negative weight");
    counts = counts || (weight > 0 && place != rows.size());
  }
  const Row rest = remainder(nullptr, 0, weights, with_plane);
  for (const Integer& value : rest) counts = counts || value != 0;
  require(counts && leastInBox(rest) >= 0, "a part of a cell is not empty");
}

Scaling::Scaling(const Map& map) {
  for (std::size_t j = 0; j < map.p; ++j) {
    const Fraction lower(map.bounds[2 * j]), upper(map.bounds[2 * j + 1]);
    require(lower < upper, "a parameter has no range");
    centre.push_back((lower + upper) / 2);
    half.push_back((upper - lower) / 2);
  }
}

Vector Scaling::mapRow(const Map& map, std::int32_t row) const {
  const double* plane = map.planes.data() + (static_cast<std::size_t>(std::abs(row)) - 1) * (map.p + 1);
  const int sign = row > 0 ? -1 : 1;
  return inBox(plane, sign, -sign * Fraction(plane[map.p]));
}

Fraction Scaling::roundingOf(const double* entries, const Fraction& reach) const {
  const std::size_t p = half.size();
  Fraction sum = abs(Fraction(entries[p]));
  for (std::size_t j = 0; j < p; ++j) sum += abs(Fraction(entries[j])) * (abs(centre[j]) + half[j] * reach);
  require(sum <= Fraction(Integer(1) << 1000), "numbers of the map are too great for doubles");
  return (p + 3) * sum / Fraction(Integer(1) << 53) + Fraction(1) / Fraction(Integer(1) << 1000);
}

}  // namespace checker
