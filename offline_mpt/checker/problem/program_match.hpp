#pragma once

#include <utility>
#include <vector>

#include "core/program.hpp"
#include "problem/optimal_control.hpp"

namespace checker {

/// Shows that the program of a certificate is the expected one, and that its parameters have these ranges. Returns the greatest difference that was found, relative
/// to the greatest entry of its row. Throws Refused where it is more than `tolerance`.
mpq_class matchProgram(const Matrices& program, const std::vector<std::pair<double, double>>& ranges,
                       const ExpectedProgram& expected, const mpq_class& tolerance);
mpq_class matchProgram(const Matrices& program, const TrackingProblem& problem,
                       const ExpectedProgram& expected, const mpq_class& tolerance);

}  // namespace checker
