#pragma once

#include <atomic>
#include <functional>
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
  const std::atomic<bool>* stop = nullptr;
  std::function<void(int iteration, std::size_t half_spaces)> progress;
};

struct InvariantSet {
  enum class Status {
    /// The maximal set: proven in exact arithmetic, else up to the tolerance at each half-space.
    kMaximal,
    /// X contains no invariant set. In floating point: none with interior.
    kEmpty,
    /// The recursion reached max_iterations. `set` contains the maximal set.
    kLimit,
    kInterrupted,
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

/// x+ = A x + c + E d where x lies in `region`; regions without common interior.
struct AffineMode {
  ExactPolytope region;
  RationalMatrix A;
  RationalVector c;
};

/// The maximal set of states that never leave the union of the regions of a piecewise-affine closed loop. The union
/// must be convex and be given as `domain`. The result is in general not convex: polytopes without common interior,
/// each within one region. Exact.
struct InvariantUnion {
  InvariantSet::Status status = InvariantSet::Status::kLimit;
  std::vector<ExactPolytope> parts;
  int iterations = 0;
};
struct UnionOptions {
  int max_iterations = 200;
  std::size_t max_parts = 20000;  ///< more: kLimit
  const std::atomic<bool>* stop = nullptr;
};

/// What is removed are states that some d takes into the interior of what was removed before, or out of the
/// domain. Boundaries are kept.
InvariantUnion maximalInvariantUnion(const std::vector<AffineMode>& modes, const ExactPolytope& domain,
                                     const RationalMatrix& E, const ExactPolytope& D,
                                     const UnionOptions& options = {});

}  // namespace polyfly
