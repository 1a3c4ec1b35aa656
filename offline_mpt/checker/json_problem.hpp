#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "core/certificate.hpp"

/// The problem that a map or a proof carries, where it is a program in JSON.
namespace checker {

/// All numbers behind a key of the outermost object, in order; none where it is missing. Refuses what is not finite.
std::vector<double> jsonNumbers(const std::string& text, const std::string& key);

/// Compares every number with those of a JSON problem.
void compareNumbers(const std::string& problem, const Matrices& program,
                    const std::set<std::size_t>& equalities);

/// The text is that of the map, and of a JSON problem every number is that of the certificate. Throws Refused.
void compareProblem(const Certificate& certificate, const Map& map, const std::string& problem);

}  // namespace checker
