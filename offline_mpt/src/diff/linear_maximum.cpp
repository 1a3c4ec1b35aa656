#include "diff/linear_maximum.hpp"

#include <cmath>

#include "arithmetic/exact_numbers.hpp"
#include "diff/tolerances.hpp"
#include "lp/box_maximum.hpp"
#include "lp/float_lp.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
LinearMaximum maximise(const std::vector<const ExactRow*>& rows, const std::vector<Rational>& function) {
  const std::size_t p = function.size() - 1;
  const Integer denominator = commonDenominator(function);
  std::vector<Integer> direction;
  std::vector<double> rounded;
  for (std::size_t j = 0; j < p; ++j) {
    direction.emplace_back(Rational(function[j] * denominator).get_num());
    rounded.push_back(function[j].get_d());
  }
  FloatLp guess(static_cast<int>(p));
  for (const ExactRow* row : rows) guess.add(row->unit);
  guess.maximise(rounded);
  BoxMaximum maximum = maximiseInBox(halfSpaces(rows), direction, guess.basis());
  if (!maximum.exists) throw Error("a linear program over two regions that meet has no solution");
  return {maximum.objective / Rational(denominator) + function[p], std::move(maximum.x)};
}

// Any weights >= 0 give a bound: direction . t <= sum of weight * b + |direction - sum of weight * a| for |t_j| <= 1.
double upperBound(const std::vector<const ExactRow*>& rows, const std::vector<double>& direction) {
  FloatLp solver(static_cast<int>(direction.size()));
  for (const ExactRow* row : rows) solver.add(row->unit);
  solver.maximise(direction);
  std::vector<double> rest = direction;
  double bound = 0.0;
  double rounding = 0.0;
  for (const auto& [index, weight] : solver.weights()) {
    // Sides of the box belong to the rest.
    if (index >= solver.count()) continue;
    const std::vector<double>& unit = rows[static_cast<std::size_t>(index)]->unit;
    bound += weight * unit.back();
    rounding += weight * (1.0 + std::abs(unit.back()));
    for (std::size_t j = 0; j < rest.size(); ++j) rest[j] -= weight * unit[j];
  }
  double side = 0.0;
  for (const double entry : rest) bound += std::abs(entry);
  for (const double entry : direction) side += std::abs(entry);
  bound += tolerance::kRoundingOfRow * (rounding + side);
  // Of a row beyond doubles, the bound is no number.
  return bound < side ? bound : side;
}

}  // namespace polyfly
