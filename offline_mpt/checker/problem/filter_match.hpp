#pragma once

#include "core/map.hpp"
#include "problem/filter_problem.hpp"

namespace checker {

/// Shows that the program of a certificate is that of a safety filter and its safe set, number by number. Throws Refused.
void matchFilter(const Matrices& program, const FilterProblem& problem);

/// Shows what "Safety filters" in offline_mpt/CERTIFICATE.md says of the safe set. Throws Refused.
void confirmSafeSet(const FilterProblem& problem);

/// Shows what it says of the answers in the safe set, of a map whose look-ups are proven. Throws Refused.
void confirmAnswers(const FilterProblem& problem, const Map& map);

}  // namespace checker
