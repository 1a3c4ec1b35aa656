#pragma once

#include "problem/robust_problem.hpp"
#include "robust/robust_certificate.hpp"

namespace checker {

/// What a certificate of a robust map has to do with its problem file.
struct RobustMatch {
  /// Greatest difference of a discretised matrix or computed gain, relative to the greatest entry of its row.
  Fraction difference;
  /// Rows that follow from the model.
  std::size_t rows = 0;
  /// Rows that bound the first step or the last one, to a set that is robustly invariant.
  std::size_t invariance_rows = 0;
  /// It is shown that no greater set is so.
  bool is_greatest = false;
};

/// Shows that the model of a certificate is that of the problem: what is discretised or computed within 2^-bits and
/// `tolerance` of the greatest entry of its row, all else exactly. Shows that its rows are those of this model. Throws
/// Refused.
RobustMatch matchRobust(const RobustCertificate& certificate, const RobustProblem& problem,
                        const Fraction& tolerance);

}  // namespace checker
