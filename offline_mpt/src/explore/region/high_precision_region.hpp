#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "exact_kkt/exact_description.hpp"
#include "explore/region/double_double_region.hpp"

namespace polyfly {

/// Describes the active sets with which doubles have trouble, and rounds once: with 32 digits where these are
/// enough, else in rational arithmetic. Each is made ready when first needed. One object, one thread.
class HighPrecisionRegionSolver {
 public:
  explicit HighPrecisionRegionSolver(const NormalisedProgram& reduced) : reduced_(reduced), exact_(reduced) {}

  /// False where the set cannot be described: its rows are dependent, or the program's equalities hold up to
  /// rounding only.
  bool solve(const std::vector<std::uint16_t>& active);

  /// Of a set that could not be described: by its own fault, not the program's.
  bool isNoSolution() const { return exact_.usable(); }

  // Of the set that was described last, in the units of NormalisedProgram; affine functions of t are p + 1
  // numbers, constant last.

  /// Of active row `place`, in the order given.
  void multiplier(std::size_t place, double* affine) const;
  /// Where H is singular: what the cost asks of active row `place`.
  void costMultiplier(std::size_t place, double* affine) const { exact_.costMultiplier(place, affine); }
  /// Of row `row` of the reduced program.
  void slack(int row, double* affine) const;
  /// q rows
  void law(std::vector<double>& out) const;

 private:
  const NormalisedProgram& reduced_;
  std::optional<DoubleDoubleRegionSolver> long_;
  ExactDescription exact_;
  // Whether long_ describes the last set.
  bool is_long_ = false;
};

}  // namespace polyfly
