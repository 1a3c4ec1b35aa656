#pragma once

#include <vector>

#include "problem/robust_problem.hpp"
#include "robust/robust_certificate.hpp"

namespace checker {

/// v M
Vector timesMatrix(const Vector& v, const Matrix& M);

/// Rows of a certificate that bound the first step: h . e_1 + g . r <= b in the worst case of the disturbances, with the
/// references r. Shows that the set {(e, r): h . e + g . r <= b for all rows} lies within the bounds of the states, and
/// that from all of it an input within its range leads back into it, whatever the disturbance. Throws Refused.
void confirmInvariant(const std::vector<const RobustCertificate::PlanRow*>& rows,
                      const RobustCertificate& certificate, const RobustProblem& problem);

}  // namespace checker
