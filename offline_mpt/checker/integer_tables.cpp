#include "integer_tables.hpp"

#include <cmath>

namespace checker {
namespace {

constexpr double kGreatestWord = 32767.0;
constexpr double kGreatestSum = 2147483647.0;
// A right shift of 32 bits that leaves a signed number.
constexpr std::uint32_t kMostShift = 30;
constexpr int kMostExponent = 62;
// The sums below are in doubles; this covers their rounding.
constexpr double kOwnRounding = 1.0 + 1e-9;

void requireWords(const std::vector<double>& numbers, double greatest) {
  for (const double number : numbers)
    require(std::abs(number) <= greatest && number == std::floor(number),
            "a number of the code needs more bits");
}

/// Numbers of up to 16 bits times parameters of up to 15 are exact in doubles, as are sums of 256 of them.
void requireSum(const double* row, double unit, double more, const LookupTables& words) {
  double sum = std::abs(row[words.p]) * unit + more;
  for (std::size_t i = 0; i < words.p; ++i) sum += std::abs(row[i]) * words.box.greatest(i);
  require(sum <= kGreatestSum, "a sum of the look-up may exceed 32 bits");
}

bool isPowerOfTwo(double value) {
  int exponent = 0;
  return value >= 1.0 && value <= kGreatestSum && std::frexp(value, &exponent) == 0.5;
}

void requireFitting(const IntegerScales& scales, const LookupTables& words) {
  const std::size_t stride = words.p + 1;
  // A parameter beyond the range of integers is limited to it, and must be outside.
  requireWords(words.box.lower, kGreatestWord - 1.0);
  requireWords(words.box.upper, kGreatestWord - 1.0);
  requireWords(words.planes, kGreatestWord);
  requireWords(words.laws, kGreatestWord);
  requireWords({words.tolerance}, kGreatestSum);
  require(words.tolerance >= 0.0, "the code's tolerance is out of range");
  require(isPowerOfTwo(scales.plane_unit) && isPowerOfTwo(scales.law_unit) && scales.plane >= 0 &&
              scales.plane <= kMostExponent && scales.greatest_input <= kGreatestWord,
          "a scale of the code is out of range");
  require(scales.law_shift.size() == words.laws.size() / stride, "the code's shifts have a wrong size");
  for (std::size_t row = 0; row < words.planes.size() / stride; ++row)
    requireSum(words.planes.data() + row * stride, scales.plane_unit, 0.0, words);
  for (std::size_t row = 0; row < scales.law_shift.size(); ++row) {
    const std::uint32_t shift = scales.law_shift[row];
    require(shift >= 1 && shift <= kMostShift, "a shift of the code is out of range");
    requireSum(words.laws.data() + row * stride, scales.law_unit, std::ldexp(0.5, static_cast<int>(shift)),
               words);
  }
}

/// What half a unit of each parameter changes in the row's value.
double fromParameters(const double* row, const LookupTables& tables) {
  double sum = 0.0;
  for (std::size_t i = 0; i < tables.p; ++i) sum += std::abs(row[i]) * tables.parameter_error[i];
  return sum * kOwnRounding;
}

}  // namespace

// Sums of integers are exact. What is rounded are the parameters and the inputs.
void scaleIntegers(const IntegerScales& scales, LookupTables& tables) {
  requireFitting(scales, tables);
  const std::size_t p = tables.p, stride = p + 1;
  for (std::size_t i = 0; i < p; ++i) {
    tables.box.lower[i] = std::ldexp(tables.box.lower[i], -scales.theta[i]);
    tables.box.upper[i] = std::ldexp(tables.box.upper[i], -scales.theta[i]);
    tables.parameter_unit.push_back(std::ldexp(1.0, -scales.theta[i]));
    tables.parameter_error.push_back(std::ldexp(0.5, -scales.theta[i]));
  }
  const auto scale = [&](double* row, int exponent, double unit) {
    for (std::size_t i = 0; i < p; ++i) row[i] = std::ldexp(row[i], scales.theta[i] - exponent);
    row[p] = std::ldexp(row[p] * unit, -exponent);
  };
  for (std::size_t at = 0; at < tables.planes.size(); at += stride) {
    scale(tables.planes.data() + at, scales.plane, scales.plane_unit);
    tables.plane_error.push_back(fromParameters(tables.planes.data() + at, tables));
  }
  for (std::size_t row = 0; row < scales.law_shift.size(); ++row) {
    const int u_exponent = scales.u[row % tables.q];
    double* const law = tables.laws.data() + row * stride;
    scale(law, static_cast<int>(scales.law_shift[row]) + u_exponent, scales.law_unit);
    tables.law_error.push_back(fromParameters(law, tables) + std::ldexp(0.5, -u_exponent));
  }
  tables.distance_unit = std::ldexp(1.0, -scales.plane);
  tables.tolerance = std::ldexp(tables.tolerance, -scales.plane);
  for (const int exponent : scales.u)
    tables.greatest_input.push_back(std::ldexp(scales.greatest_input, -exponent));
}

}  // namespace checker
