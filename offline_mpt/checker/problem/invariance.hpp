#pragma once

#include <vector>

#include "problem/polyhedron.hpp"
#include "problem/robust_problem.hpp"
#include "robust/robust_certificate.hpp"

namespace checker {

/// W is the set of the errors and references theta that meet the half-spaces. Shows that W lies within the bounds of the
/// states and that from all of W an input within its range leads back into W, whatever the disturbance, while the
/// references stay. Throws Refused.
void confirmInvariant(const std::vector<ExactHalfSpace>& set, const RobustCertificate& certificate,
                      const RobustProblem& problem);

/// Whether it is shown that each such set within the ranges of the references lies in W. It tries few steps.
bool isGreatestInvariant(const std::vector<ExactHalfSpace>& set, const RobustCertificate& certificate,
                         const RobustProblem& problem);

}  // namespace checker
