#pragma once

#include <string>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// What `verify --exact` says of a safety filter beside the optimality of its map. Empty texts for programs of
/// other types, which hold.
struct SafetyVerdict {
  bool holds = true;
  std::string text;
  std::string json;  ///< one object

  /// A report with the verdict as its key "safe_set".
  std::string addTo(const std::string& report) const;
};

/// Proves the safe set in the program's text, and what the map answers in it. Throws Error.
SafetyVerdict verifySafety(const ParametricProgram& program, const std::string& map);

}  // namespace polyfly
