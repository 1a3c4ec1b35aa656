#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "mpc_core/safety_filter.hpp"
#include "polytope_sets/exact_polytope.hpp"

namespace polyfly {

class RegionMap;

/// What holds of a safe set, decided in fractions from the doubles of the problem. Statements 1 to 4 together say
/// this. From any state of S, every admissible input leads into S, whatever the disturbances, errors and delay. There
/// always is one. The true state is in its ranges at all times, between samples too.
struct FilterProof {
  /// 1. S is bounded and not empty.
  bool bounded = false;
  std::size_t facets = 0;
  std::size_t vertices = 0;
  /// 2. S lies within the ranges, less measurement error and excursion between samples.
  bool inside = false;
  /// 3. For every state within the ranges and every admissible input, xi+ is in S for each corner of the uncertainty,
  /// with the slack left. One half-space is decided at a time.
  bool stays = false;
  /// 4. At each vertex of S, and so in all of S, some input is admissible.
  bool answered = false;
  /// What breaks the first rule that does not hold.
  std::string failure;
  /// The vertex that breaks rule 2 or 4.
  std::optional<RationalVector> counterexample;

  bool holds() const { return bounded && inside && stays && answered; }
};

/// S, in exactly the doubles of H and k.
ExactPolytope exactSet(const SafeSet& set);

/// Throws Error when the problem has no safe set, or its model cannot be sampled.
FilterProof proveFilter(const SafetyFilterProblem& problem);

/// What holds of a map's answers in S.
struct FilterAnswers {
  /// The law of each region with an empty active set is the wish itself, bit for bit, and there is such a
  /// region. Which states and wishes it holds, is what `certify` proves.
  bool passes_wishes = false;
  /// An answer of a look-up, limited to the range of the input, breaks no row by more than the slack. So the next
  /// state is in S. Counted: the tolerance of look-ups at half-spaces, and rounding of doubles.
  bool within_slack = false;
  /// The greatest part of the slack that an answer needs, rounded.
  double used = 0.0;

  bool hold() const { return passes_wishes && within_slack; }
};

/// Exact, over the vertices of each region moved outwards. The map must be of this problem, and its look-ups
/// proven (`certify`).
FilterAnswers proveAnswers(const RegionMap& map, const SafetyFilterProblem& problem);

/// What the proof says, for people and for programs. JSON: one object.
std::string filterProofText(const SafetyFilterProblem& problem, const FilterProof& proof);
std::string filterProofJson(const SafetyFilterProblem& problem, const FilterProof& proof,
                            const FilterAnswers& answers);

}  // namespace polyfly
