#pragma once

#include <vector>

#include "count/strict_complementarity_check.hpp"
#include "exact_kkt/exact_description.hpp"

namespace polyfly {

/// What StrictComplementarityCheck::at asks, where doubles leave it in doubt: of sets whose rows nearly
/// depend on each other. Multipliers and slacks are functions of t that were found in rational arithmetic and
/// rounded once. One object, one thread.
class ExactStrictComplementarity {
 public:
  ExactStrictComplementarity(const NormalisedProgram& reduced, const StrictComplementaritySystem& system,
                             const std::vector<double>& gap);

  /// `active`: rows of the reduced program.
  bool at(const std::vector<std::uint16_t>& active, const double* t, double radius, Witness& witness);

 private:
  bool coversRows(const std::vector<std::uint16_t>& active) const;
  bool positive(const std::vector<double>& affine, const Witness& witness, double& value) const;

  const NormalisedProgram& reduced_;
  const StrictComplementaritySystem& system_;
  const std::vector<double>& gap_;
  // Whether each row of the program is a row of the reduced program or an equality.
  std::vector<char> is_kept_;
  std::vector<char> is_active_;
  ExactDescription exact_;
};

}  // namespace polyfly
