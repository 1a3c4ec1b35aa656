#include "explore/region/starting_point.hpp"

#include <algorithm>

#include "explore/region/tolerances.hpp"

namespace polyfly {

bool activeSetAt(const NormalisedProgram& program, DenseQp& qp, const Eigen::VectorXd& t, double margin,
                 ActiveSet& active) {
  Eigen::VectorXd t1(program.p + 1);
  t1 << t, 1.0;
  const Eigen::VectorXd g = program.cost * t1 / tolerance::kLinearStart;
  const Eigen::VectorXd b = (program.D * t1).array() - margin;
  if (qp.solve(g.data(), b.data()) != QpStatus::kOptimal) return false;
  active.clear();
  for (int k = 0; k < qp.activeCount(); ++k) {
    const int row = qp.activeRows()[k];
    if (qp.lambda()(row) > tolerance::kActiveMultiplier) active.push_back(static_cast<std::uint16_t>(row));
  }
  std::sort(active.begin(), active.end());
  return true;
}

}  // namespace polyfly
