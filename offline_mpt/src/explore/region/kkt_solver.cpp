#include "explore/region/kkt_solver.hpp"

#include "explore/region/convex_kkt.hpp"
#include "explore/region/linear_kkt.hpp"

namespace polyfly {

std::unique_ptr<ProgramKktSolver> makeKktSolver(const NormalisedProgram& program, const RowTables& tables,
                                                const RowFactor& factor) {
  if (program.linear) return std::make_unique<LinearKktSolver>(program, tables, factor);
  return std::make_unique<ConvexKktSolver>(program, tables, factor);
}

}  // namespace polyfly
