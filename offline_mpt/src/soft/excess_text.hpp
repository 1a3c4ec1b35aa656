#pragma once

#include <algorithm>
#include <cstdio>
#include <string>

#include "mpc_core/parametric_program.hpp"
#include "soft/tolerances.hpp"

namespace polyfly {

/// An excess up to this is rounding of 0.
inline double negligibleExcess(const ParametricProgram& program) {
  return tolerance::kNoExcess * std::max(1.0, program.b.size() > 0 ? program.b.cwiseAbs().maxCoeff() : 0.0);
}

/// Six digits, for people.
inline std::string numberText(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", value);
  return text;
}

}  // namespace polyfly
