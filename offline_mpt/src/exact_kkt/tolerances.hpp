#pragma once

#include "program/tolerances.hpp"

/// Tolerances of the exact KKT systems.
namespace polyfly::tolerance {

/// Equalities with a smaller pivot depend on others up to rounding [greatest pivot].
constexpr double kDependentUpToRounding = kProgramRank;

}  // namespace polyfly::tolerance
