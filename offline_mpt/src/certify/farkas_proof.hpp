#pragma once

#include <utility>
#include <vector>

#include "exact_kkt/exact_region.hpp"
#include "lp/float_lp.hpp"

namespace polyfly {

/// Weights >= 0 that combine rows: scale * target = sum of weight * row + rest. Rows count in their unit
/// form, multiplied by the power of two that gives all of them as many bits.
struct FarkasProof {
  Integer scale = 1;                             ///< > 0
  std::vector<std::pair<int, Integer>> weights;  ///< row by its place among the given ones, > 0
};

/// Whether the proof shows target >= 0 wherever the rows are >= 0, in the box: the rest is >= 0 in all of it.
bool proves(const FarkasProof& proof, const std::vector<const ExactRow*>& rows, const ExactRow& target);

/// What became of a claim.
struct Implication {
  bool holds = false;
  /// The proof, if the implication holds.
  FarkasProof proof;
  /// If it does not hold: a point in the box where all rows are >= 0 and target < 0.
  std::vector<Rational> witness;
};

/// Decides whether target >= 0 wherever the rows are >= 0 in the box. `solver` has the dimension p.
Implication implies(const std::vector<const ExactRow*>& rows, const ExactRow& target, FloatLp& solver);

/// Decides whether rows (and the box) hold strictly at some point, on the plane of `on` if that is given.
/// Where not, `proof` combines rows, and `on` with a weight of any sign (the place after the last row), to
/// something that is nowhere positive in the box: not all of it vanishes.
struct Interior {
  bool exists = false;
  std::vector<Rational> point;
  double radius = 0.0;  ///< about; negative where rows exclude each other
  FarkasProof proof;
};
Interior findInterior(const std::vector<const ExactRow*>& rows, const ExactRow* on, int p);

/// As findInterior on no plane, without the long way where rounding leaves the answer open: kUnknown, with a
/// point that is off by rounding at most. The proof is not kept.
enum class FastInterior : std::uint8_t { kExists, kNone, kUnknown };
FastInterior findInteriorFast(const std::vector<const ExactRow*>& rows, int p, std::vector<Rational>& point);

/// Whether the proof shows that rows cannot all be > 0 inside the box, on the plane of `on`.
bool provesEmpty(const FarkasProof& proof, const std::vector<const ExactRow*>& rows, const ExactRow* on);

/// Whether all rows are > 0 at t, t lies inside the box and, if given, on the plane of `on`.
bool strictlyInside(const std::vector<Rational>& t, const std::vector<const ExactRow*>& rows,
                    const ExactRow* on);

}  // namespace polyfly
