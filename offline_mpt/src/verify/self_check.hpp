#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

class RegionMap;
struct MapContent;

struct AnswerCheckOptions {
  int threads = 1;                          ///< 1..256; the result does not depend on it
  const std::atomic<bool>* stop = nullptr;  ///< set from outside to end early
  /// Called now and then from the calling thread.
  std::function<void(std::uint64_t done, std::uint64_t total)> progress;
};

/// Result of `checkAnswers`.
struct AnswerCheck {
  std::uint64_t samples = 0;
  /// Greatest error of u where the map answers, as a share of the input's range.
  double worst = 0.0;
  /// What is wrong: parameter, region and error. Empty: nothing was found.
  std::string fault;
};

/// What whoever solves a program does before the map counts as good: AnswerChecker at seeded parameters. They are uniform ones,
/// centres of regions, and points just behind their facets. At least 200, and their number depends on the map alone. Where the
/// map answers, u must be the optimum within 1e-6 of the input's range (without one: of the greatest |u|). Where a complete map
/// is silent, no z may be feasible.
AnswerCheck checkAnswers(const RegionMap& map, const ParametricProgram& program,
                         const AnswerCheckOptions& options = {});

/// The same for a map that is not written yet, laid out as it will be.
AnswerCheck checkAnswers(const MapContent& content, const ParametricProgram& program,
                         const AnswerCheckOptions& options = {});

/// The same for a map whose first input is that of a law that is solved at each parameter; none where that has no solution.
AnswerCheck checkAnswers(const MapContent& content,
                         const std::function<std::optional<double>(const double* theta)>& first_input);

}  // namespace polyfly
