#pragma once

#include "problem/filter_problem.hpp"

namespace checker {

/// Shows that the program of a certificate is that of a safety filter and its safe set, number by number. Throws Refused.
void matchFilter(const Matrices& program, const FilterProblem& problem);

/// Shows "Safety filters" in offline_mpt/CERTIFICATE.md of the safe set. Throws Refused.
void confirmSafeSet(const FilterProblem& problem);

}  // namespace checker
