#include "exact_kkt/exact_description.hpp"

#include <algorithm>
#include <cmath>

#include "exact_kkt/exact_active_set.hpp"
#include "exact_kkt/exact_equalities.hpp"
#include "program/program_rows.hpp"

namespace polyfly {
namespace {

/// Rows that the reduced program has not are dropped.
ProgramPerturbation adjustmentOf(const NormalisedProgram& reduced) {
  const ParametricProgram& program = reduced.source;
  ProgramPerturbation adjustment;
  chooseBasis(program, program.equalities, adjustment);
  for (int row = 0; row < program.rowCount(); ++row) {
    const auto& kept = reduced.row_ids;
    if (!isEquality(program, row) && std::find(kept.begin(), kept.end(), row) == kept.end())
      adjustment.dropped.push_back(row);
  }
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
    : program(reduced.source, adjustmentOf(reduced)),
      usable(program.n - static_cast<int>(program.basis.size()) == reduced.n) {}

bool ExactDescription::prepare() {
  if (!source_) source_.emplace(reduced_);
  return source_->usable;
}

bool ExactDescription::activeSetAt(const Eigen::VectorXd& t, std::vector<std::uint16_t>& active) {
  if (!prepare()) return false;
  const auto rows =
      polyfly::activeSetAt(source_->program, std::vector<Rational>(t.data(), t.data() + t.size()), {});
  if (!rows) return false;
  active.clear();
  const auto& kept = reduced_.row_ids;
  for (const int row : *rows)
    active.push_back(static_cast<std::uint16_t>(std::find(kept.begin(), kept.end(), row) - kept.begin()));
  std::sort(active.begin(), active.end());
  return true;
}

ExactStatus ExactDescription::solve(const std::vector<std::uint16_t>& active) {
  if (!prepare()) return ExactStatus::kInconsistent;
  active_ = active;
  std::vector<int> rows;
  for (const int row : active) rows.push_back(reduced_.row_ids[static_cast<std::size_t>(row)]);
  const ExactProgram& program = source_->program;
  const ExactStatus status = solution_.solve(program, rows);
  if (status != ExactStatus::kRegion) return status;
  const bool hold =
      std::all_of(reduced_.source.equalities.begin(), reduced_.source.equalities.end(), [&](int row) {
        const auto at = static_cast<std::size_t>(row);
        if (program.in_basis[at] != 0 || program.is_dropped[at] != 0) return true;
        const std::vector<Integer> slack = solution_.slack(program, row);
        return std::all_of(slack.begin(), slack.end(), [](const Integer& value) { return value == 0; });
      });
  return hold ? ExactStatus::kRegion : ExactStatus::kInconsistent;
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
