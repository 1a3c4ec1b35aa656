#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "exact_kkt/exact_region.hpp"
#include "program/normalised_program.hpp"

namespace polyfly {

/// Describes active sets of a reduced program in rational arithmetic, for those whose rows depend on each
/// other so nearly that doubles mislead. What it gives is in the units of NormalisedProgram and rounded once. The
/// program without rounding is made when first needed. One object, one thread.
class ExactDescription {
 public:
  explicit ExactDescription(const NormalisedProgram& reduced) : reduced_(reduced) {}

  /// kInconsistent also where the program's equalities hold up to rounding only.
  ExactStatus solve(const std::vector<std::uint16_t>& active);

  // Of the set that was described last; affine functions of t are p + 1 numbers, constant last.

  /// Of active row `place`, in the order given.
  void multiplier(std::size_t place, double* affine) const;
  /// Where H is zero: what the cost asks of active row `place`.
  void costMultiplier(std::size_t place, double* affine) const;
  /// Of row `row` of the reduced program.
  void slack(int row, double* affine) const;
  /// q rows
  void law(std::vector<double>& out) const;

  /// The active set of the optimum at t into `active`, ascending, decided without rounding. False: none is found, `active` stays.
  bool activeSetAt(const Eigen::VectorXd& t, std::vector<std::uint16_t>& active);

 private:
  /// False where the program cannot be used.
  bool prepare();
  void unknown(std::size_t place, const Integer& (ExactSolution::*of)(int, int) const, long units,
               double* affine) const;

  struct Source {
    explicit Source(const NormalisedProgram& reduced);
    ExactProgram program;
    bool usable = false;  ///< leaves as many variables free as the reduced program does
  };

  const NormalisedProgram& reduced_;
  std::optional<Source> source_;
  std::vector<std::uint16_t> active_;
  ExactSolution solution_;
};

}  // namespace polyfly
