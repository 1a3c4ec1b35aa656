#pragma once

#include <string>
#include <vector>

#include "map_export/export_online.hpp"
#include "mpc_core/parametric_program.hpp"

namespace polyfly {

/// The tables of a program. Its box and A_theta bound where a map is explored; the solver takes any parameter. Throws
/// Error naming the program and the field where H is not positive definite, or no row bounds the variables.
OnlineTables onlineTables(const ParametricProgram& program);

/// The texts of a solver, and what was met as it was tried.
struct OnlineCode {
  OnlineTables tables;
  OnlineOptions options;
  TestVectors vectors;
  OnlineRecord record;
};

/// Solves at each of the parameters (p numbers each) as the code does, and by another solver in double. At least the
/// vertices of the box are tried. Throws Error where no parameter is solved, or an answer is wrong.
OnlineCode tryOnline(const ParametricProgram& program, OnlineOptions options,
                     const std::vector<std::vector<double>>& parameters);

/// Writes NAME.c, NAME.h, NAME_test.c and NAME.json. The folder is made where it is missing. Throws Error. Call
/// checkExportOutputs before the work.
void writeOnline(const OnlineCode& code, const std::string& folder);

}  // namespace polyfly
