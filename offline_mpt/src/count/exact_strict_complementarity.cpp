#include "count/exact_strict_complementarity.hpp"

#include <algorithm>
#include <cmath>

#include "arithmetic/tolerances.hpp"
#include "count/tolerances.hpp"

namespace polyfly {
ExactStrictComplementarity::ExactStrictComplementarity(const NormalisedProgram& reduced,
                                                       const StrictComplementaritySystem& system,
                                                       const std::vector<double>& gap)
    : reduced_(reduced),
      system_(system),
      gap_(gap),
      is_kept_(static_cast<std::size_t>(system.m)),
      is_active_(is_kept_),
      exact_(reduced) {
  for (const int row : reduced.row_ids) is_kept_[static_cast<std::size_t>(row)] = 1;
  for (const int row : system.equalities) is_kept_[static_cast<std::size_t>(row)] = 1;
}

// Whether each row of the program is among those asked about, or an exact multiple of an active one.
bool ExactStrictComplementarity::coversRows(const std::vector<std::uint16_t>& active) const {
  for (std::size_t i = 0; i < is_kept_.size(); ++i) {
    if (is_kept_[i]) continue;
    const bool repeats = std::any_of(active.begin(), active.end(), [&](std::uint16_t row) {
      return system_.first_of[static_cast<std::size_t>(reduced_.row_ids[row])] == system_.first_of[i];
    });
    if (!repeats) return false;
  }
  return true;
}

bool ExactStrictComplementarity::positive(const std::vector<double>& affine, const Witness& witness,
                                          double& value) const {
  value = affine.back();
  double size = std::abs(value);
  for (std::size_t j = 0; j < witness.t.size(); ++j) {
    value += affine[j] * tolerance::kWitnessStep * static_cast<double>(witness.t[j]);
    size += std::abs(affine[j]);
  }
  return value > tolerance::kRoundingSafety * tolerance::kDoubleRounding * size;
}

bool ExactStrictComplementarity::at(const std::vector<std::uint16_t>& active, const double* t, double radius,
                                    Witness& witness) {
  if (radius < tolerance::kLeastRadius || !coversRows(active) || !exact_.solve(active)) return false;
  witness.t.resize(static_cast<std::size_t>(system_.p));
  for (std::size_t j = 0; j < witness.t.size(); ++j)
    witness.t[j] = std::llround(t[j] / tolerance::kWitnessStep);
  if (!insideDomain(system_, witness)) return false;
  std::vector<double> affine(witness.t.size() + 1);
  double value = 0.0;
  std::fill(is_active_.begin(), is_active_.end(), 0);
  for (std::size_t place = 0; place < active.size(); ++place) {
    exact_.multiplier(place, affine.data());
    if (!positive(affine, witness, value)) return false;
    is_active_[active[place]] = 1;
  }
  witness.law_apart = !gap_.empty();
  for (int i = 0; i < reduced_.m; ++i) {
    if (is_active_[static_cast<std::size_t>(i)]) continue;
    exact_.slack(i, affine.data());
    if (!positive(affine, witness, value)) return false;
    const auto row = static_cast<std::size_t>(reduced_.row_ids[static_cast<std::size_t>(i)]);
    if (witness.law_apart)
      witness.law_apart = value * reduced_.length(i) > tolerance::kClearlyApart * gap_[row];
  }
  return true;
}

}  // namespace polyfly
