#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "core/map.hpp"
#include "problem/filter_problem.hpp"

namespace checker {

/// Shows that the program of a certificate is that of a safety filter and its safe set, number by number. Throws Refused.
void matchFilter(const Matrices& program, const FilterProblem& problem);

/// Whether `whole` is the text of a problem file, followed by the key safe_set and nothing else.
bool isCompletedText(const std::string& whole, const std::string& file);

/// Is told how far a check is.
using Progress = std::function<void(const char* kind, std::size_t done, std::size_t total)>;

/// Shows what "Safety filters" in offline_mpt/checker/README.md says of the set. Throws Refused.
void confirmSafeSet(const FilterProblem& problem, const Progress& progress = {});

/// Shows what it says of the answers in the safe set, of a map whose look-ups are proven. Throws Refused.
void confirmAnswers(const FilterProblem& problem, const Map& map, const Progress& progress = {});

}  // namespace checker
