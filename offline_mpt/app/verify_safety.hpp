#pragma once

#include <string>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// What `verify --exact` says of a safety filter beside the optimality of its map. Empty texts for programs of
/// other types, which hold.
struct SafetyVerdict {
  bool holds = true;
  /// Whether an admissible wish comes back bit for bit.
  bool passes_wishes = false;
  std::string text;
  std::string json;  ///< one object

  /// A report with the verdict as its key "safe_set".
  std::string addTo(const std::string& report) const;
};

/// Proves the safe set in the program's text, and that the map passes wishes unchanged. Throws Error.
SafetyVerdict verifySafety(const ParametricProgram& program, const std::string& map);

}  // namespace polyfly
