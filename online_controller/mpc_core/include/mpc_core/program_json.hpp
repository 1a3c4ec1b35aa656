#pragma once

#include <string>

#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// The program in the generic JSON form, with names, units, period, names of rows and slacks. parseProgramJson reads
/// the same numbers back. The same program gives the same text.
std::string programJson(const ParametricProgram& program);

}  // namespace polyfly
