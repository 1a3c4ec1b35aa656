#include "exact_kkt/exact_description.hpp"

#include <algorithm>
#include <cmath>

#include "exact_kkt/exact_equalities.hpp"

namespace polyfly {
namespace {

ProgramPerturbation adjustmentOf(const ParametricProgram& program) {
  ProgramPerturbation adjustment;
  chooseBasis(program, program.equalities, adjustment);
  return adjustment;
}

/// numerator / denominator * 2^exponent, rounded.
double quotient(const Integer& numerator, const Integer& denominator, long exponent) {
  signed long above = 0, below = 0;
  const double top = mpz_get_d_2exp(&above, numerator.get_mpz_t());
  const double bottom = mpz_get_d_2exp(&below, denominator.get_mpz_t());
  constexpr long kBeyondDoubles = 5000;
  return std::ldexp(top / bottom,
                    static_cast<int>(std::clamp(above - below + exponent, -kBeyondDoubles, kBeyondDoubles)));
}

}  // namespace

ExactDescription::Source::Source(const NormalisedProgram& reduced)
    : program(reduced.source, adjustmentOf(reduced.source)),
      usable(program.n - static_cast<int>(program.basis.size()) == reduced.n) {}

bool ExactDescription::solve(const std::vector<std::uint16_t>& active) {
  if (!source_) source_.emplace(reduced_);
  if (!source_->usable) return false;
  active_ = active;
  std::vector<int> rows;
  for (const int row : active) rows.push_back(reduced_.row_ids[static_cast<std::size_t>(row)]);
  const ExactProgram& program = source_->program;
  if (solution_.solve(program, rows) != ExactStatus::kRegion) return false;
  return std::all_of(reduced_.source.equalities.begin(), reduced_.source.equalities.end(), [&](int row) {
    const auto at = static_cast<std::size_t>(row);
    if (program.in_basis[at] != 0 || program.is_dropped[at] != 0) return true;
    const std::vector<Integer> slack = solution_.slack(program, row);
    return std::all_of(slack.begin(), slack.end(), [](const Integer& value) { return value == 0; });
  });
}

void ExactDescription::multiplier(std::size_t place, double* affine) const {
  unknown(place, &ExactSolution::multiplier, source_->program.H_exponent, affine);
}

void ExactDescription::costMultiplier(std::size_t place, double* affine) const {
  unknown(place, &ExactSolution::costMultiplier, source_->program.H_exponent, affine);
}

void ExactDescription::unknown(std::size_t place, const Integer& (ExactSolution::*of)(int, int) const,
                               long units, double* affine) const {
  const ExactProgram& program = source_->program;
  const auto row = static_cast<std::size_t>(reduced_.row_ids[active_[place]]);
  const long exponent = program.row_exponent[row] - units - program.shift;
  const int r = static_cast<int>(program.basis.size() + place);
  const double length = reduced_.length(active_[place]);
  for (int j = 0; j <= program.p; ++j)
    affine[j] = length * quotient((solution_.*of)(r, j), solution_.denominator(), exponent);
}

void ExactDescription::slack(int row, double* affine) const {
  const ExactProgram& program = source_->program;
  const int id = reduced_.row_ids[static_cast<std::size_t>(row)];
  const std::vector<Integer> value = solution_.slack(program, id);
  const long exponent = -program.row_exponent[static_cast<std::size_t>(id)] - program.shift;
  for (int j = 0; j <= program.p; ++j)
    affine[j] = quotient(value[static_cast<std::size_t>(j)], solution_.denominator(), exponent) /
                reduced_.length(row);
}

void ExactDescription::law(std::vector<double>& out) const {
  out.clear();
  for (const Rational& value : solution_.law(source_->program)) out.push_back(value.get_d());
}

}  // namespace polyfly
