#include "soft/active_solution.hpp"

#include "mpc_core/decompositions.hpp"
#include "soft/tolerances.hpp"

namespace polyfly {

ActiveSolution solveActiveSet(const ParametricProgram& program, const std::vector<int>& active) {
  const Eigen::Index n = program.variableCount();
  const Eigen::Index p = program.parameterCount();
  const auto w = static_cast<Eigen::Index>(active.size());
  Eigen::MatrixXd kkt = Eigen::MatrixXd::Zero(n + w, n + w);
  Eigen::MatrixXd right(n + w, p + 1);
  kkt.topLeftCorner(n, n) = program.H;
  right.topRows(n) << -program.F, -program.f;
  for (Eigen::Index i = 0; i < w; ++i) {
    const int row = active[static_cast<std::size_t>(i)];
    kkt.row(n + i).head(n) = program.A.row(row);
    kkt.col(n + i).head(n) = program.A.row(row).transpose();
    right.row(n + i) << program.S.row(row), program.b(row);
  }
  const PivotedQr qr(kkt, tolerance::kIndependentEquations);
  ActiveSolution solution;
  solution.independent = qr.rank() == n + w;
  const Eigen::MatrixXd all = qr.solve(right);
  solution.on_theta = all.leftCols(p);
  solution.constant = all.col(p);
  return solution;
}

}  // namespace polyfly
