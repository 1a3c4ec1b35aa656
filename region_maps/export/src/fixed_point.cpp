#include "fixed_point.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "code_tables.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

/// Room for answers just beyond an input's bounds.
constexpr double kInputRoom = 1.0 / 64.0;
constexpr double kGreatestSum = 2147483647.0;
constexpr int kMostExponent = 30;

/// The greatest e with value * 2^e <= limit; `most` for zero.
int greatestExponent(double value, double limit, int most) {
  if (value == 0.0) return most;
  int exponent = 0;
  std::frexp(limit / value, &exponent);
  while (std::ldexp(value, exponent) > limit) --exponent;
  return std::min(exponent, most);
}

double nearestWord(double value, int exponent) { return std::nearbyint(std::ldexp(value, exponent)); }

/// Greatest size of a parameter, as an integer.
std::vector<double> greatestWords(const std::vector<double>& box) {
  std::vector<double> greatest;
  for (std::size_t i = 0; i < box.size(); i += 2)
    greatest.push_back(std::max(std::abs(box[i]), std::abs(box[i + 1])));
  return greatest;
}

/// A parameter beyond the range of integers, limited to it, must be outside of the box.
void fillBox(const std::vector<double>& box, CodeTables& tables) {
  constexpr int kMostBits = 200;
  for (std::size_t i = 0; i < box.size(); i += 2) {
    const double greatest = std::max(std::abs(box[i]), std::abs(box[i + 1]));
    const int exponent = greatestExponent(greatest, kGreatestWord - 1, kMostBits);
    tables.fixed.theta_exponent.push_back(exponent);
    tables.box.push_back(std::floor(std::ldexp(box[i], exponent)));
    tables.box.push_back(std::ceil(std::ldexp(box[i + 1], exponent)));
  }
}

/// The numbers of one plane or of one row of a law as integers.
class RowScaler {
 public:
  RowScaler(const std::vector<double>& greatest, const std::vector<int>& theta_exponent)
      : greatest_(greatest), theta_exponent_(theta_exponent) {}

  /// The p + 1 integers for distances or sums with this exponent, whose constant counts 2^unit.
  std::vector<double> scaled(const double* row, int exponent, int unit) const {
    std::vector<double> result;
    for (std::size_t k = 0; k < greatest_.size(); ++k)
      result.push_back(nearestWord(row[k], exponent - theta_exponent_[k]));
    result.push_back(nearestWord(row[greatest_.size()], exponent - unit));
    return result;
  }

  /// Whether each number fits a word, and each sum 32 bits, with `more` added.
  bool fits(const std::vector<double>& words, int unit, double more) const {
    double sum = more;
    for (std::size_t k = 0; k < words.size(); ++k) {
      const double size = std::abs(words[k]);
      if (!(size <= kGreatestWord)) return false;
      sum += k < greatest_.size() ? size * greatest_[k] : std::ldexp(size, unit);
    }
    return sum <= kGreatestSum;
  }

 private:
  const std::vector<double>& greatest_;
  const std::vector<int>& theta_exponent_;
};

/// Distances of all planes have one scale, so that violations can be compared.
bool fillPlanes(const RegionMap& map, const RowScaler& scaler, int exponent, CodeTables& tables) {
  tables.planes.clear();
  for (std::size_t i = 0; i < map.planeCount(); ++i) {
    const std::vector<double> words = scaler.scaled(map.plane(i), exponent, kPlaneUnit);
    if (!scaler.fits(words, kPlaneUnit, 0.0)) return false;
    tables.planes.insert(tables.planes.end(), words.begin(), words.end());
  }
  tables.fixed.plane_exponent = exponent;
  return true;
}

/// Greatest error of a plane's value: rounding of parameters and of the table. [units of distance]
double greatestPlaneError(const RegionMap& map, const CodeTables& tables) {
  const std::size_t p = map.parameters().size();
  const FixedPoint& fixed = tables.fixed;
  const std::vector<double> theta = greatestWords(tables.box);
  double greatest = 0.0;
  for (std::size_t i = 0; i < map.planeCount(); ++i) {
    const double* const plane = map.plane(i);
    const double* const words = tables.planes.data() + i * (p + 1);
    const double constant = std::ldexp(plane[p], fixed.plane_exponent - kPlaneUnit);
    double error = std::ldexp(std::abs(words[p] - constant), kPlaneUnit);
    for (std::size_t k = 0; k < p; ++k) {
      const double entry = std::ldexp(plane[k], fixed.plane_exponent - fixed.theta_exponent[k]);
      error += std::abs(words[k] - entry) * theta[k] + 0.5 * std::abs(entry);
    }
    greatest = std::max(greatest, error);
  }
  return greatest;
}

/// The bounds of the input where they are finite, else those of the laws anywhere in the box.
double greatestInput(const RegionMap& map, std::size_t input, const std::vector<double>& box) {
  const Signal& signal = map.inputs()[input];
  const double bound = std::max(std::abs(signal.lower), std::abs(signal.upper));
  if (std::isfinite(bound) && bound > 0.0) return bound * (1.0 + kInputRoom);
  const std::size_t p = map.parameters().size();
  double greatest = 0.0;
  for (std::size_t i = 0; i < map.lawCount(); ++i) {
    const double* const row = map.law(i) + input * (p + 1);
    double size = std::abs(row[p]);
    for (std::size_t k = 0; k < p; ++k)
      size += std::abs(row[k]) * std::max(std::abs(box[2 * k]), std::abs(box[2 * k + 1]));
    greatest = std::max(greatest, size);
  }
  return greatest * (1.0 + kInputRoom);
}

void fillLaws(const RegionMap& map, const RowScaler& scaler, CodeTables& tables) {
  const std::size_t p = map.parameters().size(), m = map.inputs().size();
  for (std::size_t row = 0; row < map.lawCount() * m; ++row) {
    const double* const law = map.law(row / m) + row % m * (p + 1);
    const int u_exponent = tables.fixed.u_exponent[row % m];
    int shift = kMostShift;
    std::vector<double> words;
    // Half of what the shift drops is added, so that it rounds to the nearest.
    while (shift > 0) {
      words = scaler.scaled(law, shift + u_exponent, kLawUnit);
      if (scaler.fits(words, kLawUnit, std::ldexp(0.5, shift))) break;
      --shift;
    }
    if (shift == 0) {
      throw Error("--type int16: the gain of '" + map.inputs()[row % m].name +
                  "' needs more bits; use float or double");
    }
    tables.fixed.law_shift.push_back(static_cast<std::uint32_t>(shift));
    tables.laws.insert(tables.laws.end(), words.begin(), words.end());
  }
}

}  // namespace

void fillFixedPoint(const RegionMap& map, const std::vector<double>& box, double errors, CodeTables& tables) {
  fillBox(box, tables);
  const std::vector<double> greatest = greatestWords(tables.box);
  const RowScaler scaler(greatest, tables.fixed.theta_exponent);
  int exponent = kMostExponent;
  while (exponent > 0 && !fillPlanes(map, scaler, exponent, tables)) --exponent;
  if (exponent == 0) throw Error("--type int16: a half-space needs more bits; use float or double");
  constexpr int kMostBits = 200;
  for (std::size_t j = 0; j < map.inputs().size(); ++j)
    tables.fixed.u_exponent.push_back(greatestExponent(greatestInput(map, j, box), kGreatestWord, kMostBits));
  fillLaws(map, scaler, tables);
  tables.tolerance =
      std::ceil(std::ldexp(map.tolerance(), exponent) + errors * greatestPlaneError(map, tables));
  if (!(tables.tolerance <= kGreatestSum))
    throw Error("--type int16: the half-spaces' rounding needs a tolerance beyond its range");
}

}  // namespace polyfly
