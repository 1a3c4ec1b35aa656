#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

class RegionMap;
struct MapContent;

/// Result of `checkAnswers`.
struct AnswerCheck {
  std::uint64_t samples = 0;
  /// Greatest error of u where the map answers, as a share of the input's range.
  double worst = 0.0;
  /// What is wrong: parameter, region and error. Empty: nothing was found.
  std::string fault;
};

/// Checks a map against the numbers of its program at seeded parameters: uniform ones, centres of regions, and points just
/// behind their facets. At least 200, and their number depends on the map alone. Where the map answers, u must be the
/// optimum within 1e-6 of the input's range (without one: of the greatest |u|). Where a complete map is silent, no z may be
/// feasible. The arithmetic has 32 digits, and where it says that the map is wrong, exact linear programs decide. The result
/// does not depend on `threads`.
AnswerCheck checkAnswers(const RegionMap& map, const ParametricProgram& program, int threads);

/// The same for a map that is not written yet, laid out as it will be.
AnswerCheck checkAnswers(const MapContent& content, const ParametricProgram& program, int threads);

/// The same for a map whose first input is that of a law that is solved at each parameter; none where that has no solution.
AnswerCheck checkAnswers(const MapContent& content,
                         const std::function<std::optional<double>(const double* theta)>& first_input);

}  // namespace polyfly
