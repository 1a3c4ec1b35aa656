#include "diff/linear_maximum.hpp"

#include <cmath>

#include "diff/tolerances.hpp"
#include "lp/exact_simplex.hpp"
#include "lp/float_lp.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
// The basis at which floating point stops is mostly the optimal one.
LinearMaximum maximise(const std::vector<const ExactRow*>& rows, const std::vector<Rational>& function) {
  const std::size_t p = function.size() - 1;
  Integer denominator(1);
  for (const Rational& entry : function)
    mpz_lcm(denominator.get_mpz_t(), denominator.get_mpz_t(), entry.get_den_mpz_t());
  std::vector<Integer> direction;
  std::vector<double> rounded;
  for (std::size_t j = 0; j < p; ++j) {
    direction.emplace_back(Rational(function[j] * denominator).get_num());
    rounded.push_back(function[j].get_d());
  }
  FloatLp guess(static_cast<int>(p));
  ExactSimplex solver(static_cast<int>(p));
  for (const ExactRow* row : rows) {
    guess.add(row->unit);
    std::vector<Integer> a_b = row->value;
    for (std::size_t j = 0; j < p; ++j) a_b[j] = -a_b[j];
    solver.add(std::move(a_b));
  }
  const bool guessed = guess.maximise(rounded) == FloatLp::Status::kOptimal;
  if (solver.maximise(direction, guessed ? guess.basis() : std::vector<int>()) !=
      ExactSimplex::Status::kOptimal)
    throw Error("a linear program over two regions that meet has no solution");
  return {solver.objective() / Rational(denominator) + function[p], solver.x()};
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
