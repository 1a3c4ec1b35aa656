#pragma once

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

class RegionMap;

/// Throws Error, which names the map and the field, unless the map has the parameters, the inputs and the period of the
/// program: the same names and units in the same order. Ranges differ by at most `range_difference` times max(1, |bound|).
void requireSameSignals(const RegionMap& map, const ParametricProgram& program,
                        double range_difference = 0.0);

}  // namespace polyfly
