#pragma once

#include "problem/robust_problem.hpp"
#include "robust/robust_certificate.hpp"

namespace checker {

struct RowMatch {
  /// Rows that the model and the bounds give.
  std::size_t expected = 0;
  /// Other rows: half-spaces of an invariant set, of the state after the first step or the last one, and of the references.
  std::size_t invariant = 0;
  /// It is shown that no greater set is invariant.
  bool is_greatest = false;
};

/// Computes the rows of the robust MPC from the model of the certificate, in fractions, and finds each of them in the
/// certificate as often as it occurs. Other rows are refused, but for those of `invariance`, whose set must be
/// robustly invariant (invariance.hpp). The plan is the inputs u~_1 .., then the disturbance feedback L_ki by k, i and
/// channel. Throws Refused.
RowMatch matchRows(const RobustCertificate& certificate, const RobustProblem& problem);

}  // namespace checker
