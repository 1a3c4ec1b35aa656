#include "identification/random_effects.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <iterator>

namespace polyfly {
namespace {

// Two-sided 95 % factors of Student's distribution for 1, 2, ... degrees of freedom.
constexpr double kStudent[] = {12.7062, 4.3027, 3.1824, 2.7764, 2.5706,
                               2.4469,  2.3646, 2.3060, 2.2622, 2.2281};
// The same factor of the normal distribution.
constexpr double kNormal = 1.959964;
// Least standard error as a share of the greatest value. Values without error would have infinite weight.
constexpr double kLeastError = 1e-9;
constexpr int kBisections = 200;

// Errors that can be divided by.
std::vector<FlightValue> weighable(std::vector<FlightValue> flights) {
  double size = 0.0;
  double greatest = 0.0;
  for (const FlightValue& flight : flights) {
    size = std::max(size, std::abs(flight.value));
    if (std::isfinite(flight.standard_error)) greatest = std::max(greatest, flight.standard_error);
  }
  for (FlightValue& flight : flights) {
    if (!std::isfinite(flight.standard_error)) flight.standard_error = greatest;
    flight.standard_error = std::max(flight.standard_error, kLeastError * size);
  }
  return flights;
}

struct WeightedMean {
  double mean = 0.0;
  double weight = 0.0;
  // Sum of the weighted squared deviations from the mean.
  double deviations = 0.0;
};

WeightedMean weightedMean(const std::vector<FlightValue>& flights, double between) {
  WeightedMean result;
  const auto weight = [between](const FlightValue& flight) {
    return 1.0 / (flight.standard_error * flight.standard_error + between);
  };
  for (const FlightValue& flight : flights) {
    result.weight += weight(flight);
    result.mean += weight(flight) * flight.value;
  }
  result.mean /= result.weight;
  for (const FlightValue& flight : flights) {
    result.deviations += weight(flight) * (flight.value - result.mean) * (flight.value - result.mean);
  }
  return result;
}

// The variance between flights with which the weighted deviations are what chance makes of them. They fall as
// it grows, and are below at the sum of all squares.
double varianceBetween(const std::vector<FlightValue>& flights) {
  const auto expected = static_cast<double>(flights.size() - 1);
  if (weightedMean(flights, 0.0).deviations <= expected) return 0.0;
  double mean = 0.0;
  for (const FlightValue& flight : flights) mean += flight.value / static_cast<double>(flights.size());
  double lower = 0.0;
  double upper = 0.0;
  for (const FlightValue& flight : flights) upper += (flight.value - mean) * (flight.value - mean);
  for (int i = 0; i < kBisections && lower < upper; ++i) {
    const double middle = 0.5 * (lower + upper);
    (weightedMean(flights, middle).deviations > expected ? lower : upper) = middle;
  }
  return upper;
}

}  // namespace

double studentFactor(int degrees) {
  assert(degrees >= 1);
  if (degrees <= static_cast<int>(std::size(kStudent))) return kStudent[degrees - 1];
  // Expansion of Cornish and Fisher in the inverse of the degrees.
  const double z = kNormal;
  const double z2 = z * z;
  const double first = z * (z2 + 1.0) / 4.0;
  const double second = z * ((5.0 * z2 + 16.0) * z2 + 3.0) / 96.0;
  const double third = z * (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) / 384.0;
  const double inverse = 1.0 / static_cast<double>(degrees);
  return z + inverse * (first + inverse * (second + inverse * third));
}

PooledValue poolFlights(const std::vector<FlightValue>& flights) {
  assert(flights.size() >= 2);
  PooledValue pooled;
  const bool all_zero = std::all_of(flights.begin(), flights.end(),
                                    [](const FlightValue& flight) { return flight.value == 0.0; });
  const std::vector<FlightValue> all = weighable(flights);
  if (all_zero && all.front().standard_error == 0.0) {
    // A parameter at its bound in every flight.
    pooled.standard_error = pooled.half_width = std::nan("");
    return pooled;
  }
  const double between = varianceBetween(all);
  const WeightedMean mean = weightedMean(all, between);
  pooled.value = mean.mean;
  pooled.standard_error = 1.0 / std::sqrt(mean.weight);
  pooled.half_width = studentFactor(static_cast<int>(all.size()) - 1) * pooled.standard_error;
  pooled.between_flights = std::sqrt(between);
  return pooled;
}

}  // namespace polyfly
