#pragma once

#include <optional>
#include <vector>

#include "polytope_sets/exact_polytope.hpp"
#include "polytope_sets/set_model.hpp"

namespace polyfly {

struct InvariantOptions {
  /// Fractions throughout: a set that is found is proven to be the maximal one. The numbers grow by some
  /// digits with every step. Else floating point, rounded after each step.
  bool exact = true;
  /// In floating point, distances below this count as zero.
  double tolerance = 1e-9;
  int max_iterations = 200;  ///< at least 1
};

struct InvariantSet {
  enum class Status {
    /// The maximal set: proven in exact arithmetic, else up to the tolerance at each half-space.
    kMaximal,
    /// X contains no invariant set. In floating point: none with interior.
    kEmpty,
    /// The recursion reached max_iterations. `set` contains the maximal set.
    kLimit,
  };
  Status status = Status::kLimit;
  ExactPolytope set;  ///< no redundant rows
  int iterations = 0;
};

/// The states of `set` and X from which some u in U leads into `set` for all d in D:
///
///     Pre(S) = {x in X and S : there is u in U with A x + B u + E d + c in S for all d in D}
///
/// the intersection with S is what the recursion needs. Without inputs it is the set of states that stay.
ExactPolytope predecessor(const SetModel& model, const ExactPolytope& set);

/// The maximal robust control invariant set in X. Without disturbances it is control invariant, without inputs
/// positively invariant. C_0 = X, C_{k+1} = Pre(C_k), until C_{k+1} = C_k (Bertsekas, 1972; Blanchini, 1999). A
/// parameter that is no state must not be in the model. Throws Error when X or U is unbounded.
InvariantSet maximalInvariantSet(const SetModel& model, const InvariantOptions& options = {});

/// Decides in fractions whether every state of `set` has an input that keeps it there for all disturbances.
/// `counterexample`: a vertex for which there is none, or which lies outside of X.
struct InvarianceProof {
  bool holds = false;
  std::optional<RationalVector> counterexample;
};
InvarianceProof proveInvariant(const SetModel& model, const ExactPolytope& set);

}  // namespace polyfly
