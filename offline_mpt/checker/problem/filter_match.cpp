#include "problem/filter_match.hpp"

#include "problem/fields.hpp"
#include "problem/optimal_control.hpp"
#include "problem/program_match.hpp"

namespace checker {
namespace {

/// Minimise sum of weight (u - wish)^2 / 2 over z = u, theta = (xi, wish).
ExpectedProgram filterProgram(const FilterProblem& problem) {
  const std::size_t nu = problem.inputCount(), n = problem.size(), p = n + nu;
  ExpectedProgram result;
  const auto add_row = [&](const Fraction& bound) -> ExpectedRow& {
    result.rows.push_back({std::vector<Ball>(nu), std::vector<Ball>(p), Ball(bound)});
    return result.rows.back();
  };
  result.H = BallMatrix(nu, nu);
  result.F = BallMatrix(nu, p + 1);
  result.C = BallMatrix(nu, p + 1);
  for (std::size_t j = 0; j < nu; ++j) {
    result.H.at(j, j) = Ball(Fraction(problem.weights[j]));
    result.F.at(j, n + j) = -result.H.at(j, j);
    add_row(Fraction(problem.inputs[j].second)).on_z[j] = Ball(1);
    add_row(Fraction(-problem.inputs[j].first)).on_z[j] = Ball(-1);
  }
  for (std::size_t i = 0; i < problem.G.rows; ++i) {
    ExpectedRow& row = add_row(problem.b.at(i, 0));
    for (std::size_t j = 0; j < nu; ++j) row.on_z[j] = Ball(problem.G.at(i, j));
    for (std::size_t j = 0; j < n; ++j) row.on_theta[j] = Ball(problem.M.at(i, j));
  }
  return result;
}

}  // namespace

bool isCompletedText(const std::string& whole, const std::string& file) {
  if (whole.compare(0, file.size(), file) != 0) return false;
  const std::string rest = whole.substr(file.size());
  if ((file.empty() || file.back() != '\n') && (rest.empty() || rest.front() != '\n')) return false;
  try {
    const YAML::Node added = documentOf(rest);
    return added.IsMap() && added.size() == 1 && added["safe_set"];
  } catch (const YAML::Exception&) {
    return false;
  }
}

void matchFilter(const Matrices& program, const FilterProblem& problem) {
  std::vector<std::pair<double, double>> ranges = problem.states;
  if (problem.hasDelay()) ranges.insert(ranges.end(), problem.inputs.begin(), problem.inputs.end());
  ranges.insert(ranges.end(), problem.wishes.begin(), problem.wishes.end());
  matchProgram(program, {}, ranges, filterProgram(problem), 0);
}

}  // namespace checker
