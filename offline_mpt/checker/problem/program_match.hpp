#pragma once

#include <set>
#include <utility>
#include <vector>

#include "core/program.hpp"
#include "problem/optimal_control.hpp"
#include "problem/rounding_effect.hpp"

namespace checker {

/// How far the program of a certificate is from the expected one.
struct ProgramMatch {
  /// Greatest difference of a number, relative to the greatest entry of its row.
  mpq_class difference;
  /// What the differences may change in an input, as a share of its range.
  mpq_class effect;
  /// ExpectedProgram::riccati_residual
  mpq_class riccati_residual;
  Variables variables = Variables::kInputs;
};

/// Shows that the program of a certificate is the expected one, and that its parameters have these ranges: each number
/// within `tolerance` of the greatest entry of its row. Throws Refused.
mpq_class matchProgram(const Matrices& program, const std::set<std::size_t>& equalities, const Ranges& ranges,
                       const ExpectedProgram& expected, const mpq_class& tolerance,
                       RoundingEffect* effect = nullptr);
/// The same of a tracking problem, and that the differences change no input by more than a millionth of its range.
ProgramMatch matchProgram(const Matrices& program, const std::set<std::size_t>& equalities,
                          const TrackingProblem& problem, const ExpectedProgram& expected,
                          const mpq_class& tolerance);
/// The same in the inputs, or else beside a feedback.
ProgramMatch matchProgram(const Matrices& program, const std::set<std::size_t>& equalities,
                          const TrackingProblem& problem, const mpq_class& tolerance);

}  // namespace checker
