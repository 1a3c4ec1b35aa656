#include "program/feasible_slack.hpp"

#include <algorithm>

#include "lp/polytope.hpp"
#include "program/tolerances.hpp"

namespace polyfly {
std::optional<double> feasibleSlack(const NormalisedProgram& program, const Eigen::VectorXd& t) {
  if (program.n < 1 || program.n > PolytopeSolver::kMaxDimension) return std::nullopt;
  Eigen::VectorXd t1(program.p + 1);
  t1 << t, 1.0;
  const Eigen::VectorXd bound = program.S * t1;
  std::vector<double> rows;
  double distance = 1.0;
  for (int i = 0; i < program.m; ++i) {
    const double length = program.A.row(i).norm();
    for (int j = 0; j < program.n; ++j) rows.push_back(program.A(i, j) / length);
    rows.push_back(bound(i) / length);
    distance = std::max(distance, std::abs(rows.back()));
  }
  for (int j = 0; j < program.n; ++j) {
    for (const double sign : {-1.0, 1.0}) {
      rows.insert(rows.end(), static_cast<std::size_t>(program.n) + 1, 0.0);
      rows[rows.size() - 1 - static_cast<std::size_t>(program.n) + static_cast<std::size_t>(j)] = sign;
      rows.back() = tolerance::kSearchBox * distance;
    }
  }
  PolytopeSolver solver(program.n);
  std::vector<double> centre(static_cast<std::size_t>(program.n), 0.0);
  double slack = 0.0;
  const int count = program.m + 2 * program.n;
  if (!solver.chebyshev(rows.data(), count, centre.data(), slack)) return std::nullopt;
  return slack;
}

}  // namespace polyfly
