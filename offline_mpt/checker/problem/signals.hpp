#pragma once

#include <string>

#include "core/map.hpp"

namespace checker {

/// What a problem in YAML says after `type`. Throws Refused.
std::string problemType(const std::string& problem);

/// Shows that parameters and inputs of the map are those of the problem: names, units and order, ranges within 1e-12, and
/// the period. `problem` is YAML of a type that check_problem knows, or JSON. Throws Refused.
void matchSignals(const Map& map, const std::string& problem);

}  // namespace checker
