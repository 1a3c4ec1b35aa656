#pragma once

#include "core/program.hpp"
#include "problem/optimal_control.hpp"

namespace checker {

/// Shows that the program of a certificate is the expected one. Returns the greatest difference that was found, relative
/// to the greatest entry of its row. Throws Refused where it is more than `tolerance`.
mpq_class matchProgram(const Matrices& program, const TrackingProblem& problem,
                       const ExpectedProgram& expected, const mpq_class& tolerance);

}  // namespace checker
