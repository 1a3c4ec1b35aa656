#include <algorithm>
#include <limits>
#include <utility>

#include "polyfly_base/error.hpp"
#include "polytope_sets/polytope.hpp"
#include "rational_parts.hpp"
#include "robust_mpc/robust_law.hpp"

namespace polyfly {
namespace {

/// Region half-spaces in doubles, each row a distance where every range is [-1, 1]; scaled before rounding.
Polytope scaledRegion(const RobustProblem& problem, const ExactPolytope& region) {
  ExactPolytope scaled = region;
  for (ExactHalfSpace& row : scaled.rows) {
    for (int j = 0; j < scaled.dimension; ++j) {
      const RobustProblem::Range& range = problem.parameters[at(j)].range;
      row.b -= row.a[at(j)] * (range.upper + range.lower) / 2;
      row.a[at(j)] *= (range.upper - range.lower) / 2;
    }
  }
  return rounded(scaled);
}

CriticalRegion roundRegion(const RobustProblem& problem, const RobustLaw::Region& region) {
  const int np = problem.parameterCount();
  CriticalRegion result;
  result.active = region.active;
  std::sort(result.active.begin(), result.active.end());
  const Polytope scaled = scaledRegion(problem, region.polytope);
  const Ball ball = chebyshevBall(scaled);
  result.radius = ball.radius;
  result.centre.resize(np);
  result.G.resize(scaled.rowCount(), np);
  result.g = scaled.b;
  for (int j = 0; j < np; ++j) {
    const Signal& signal = problem.parameters[at(j)].signal;
    const double centre = 0.5 * (signal.lower + signal.upper), half = 0.5 * (signal.upper - signal.lower);
    result.centre[j] = centre + half * ball.centre[j];
    result.G.col(j) = scaled.A.col(j) / half;
    result.g += result.G.col(j) * centre;
  }
  const int outputs = problem.peak_in_map ? 2 : 1;
  result.K.resize(outputs, np);
  result.k.resize(outputs);
  for (int j = 0; j < np; ++j) {
    Rational gain = region.input_gain[at(j)];
    if (problem.parameters[at(j)].state < 0) gain += problem.parameters[at(j)].input_shift[0];
    result.K(0, j) = nearestDouble(gain);
    if (outputs > 1) result.K(1, j) = nearestDouble(region.peak_gain[at(j)]);
  }
  result.k[0] = nearestDouble(region.input_offset);
  if (outputs > 1) result.k[1] = nearestDouble(region.peak_offset);
  return result;
}

ParametricProgram programOf(const RobustProblem& problem) {
  ParametricProgram program;
  program.name = problem.name;
  program.text = problem.text;
  program.text_kind = "yaml";
  program.period = problem.sampling_time;
  for (const RobustProblem::Parameter& parameter : problem.parameters)
    program.parameters.push_back(parameter.signal);
  program.inputs = problem.inputs;
  if (problem.peak_in_map) {
    Signal peak{"tau", "1", nearestDouble(problem.floor), std::numeric_limits<double>::infinity()};
    program.inputs.push_back(std::move(peak));
  }
  return program;
}

}  // namespace

RoundedLaw roundLaw(const RobustProblem& problem, const RobustLaw& law, ExploreStatus status) {
  RoundedLaw result{programOf(problem), {}};
  result.partition.status = status;
  for (const RobustLaw::Region& region : law.regions)
    result.partition.regions.push_back(roundRegion(problem, region));
  result.partition.stats.regions = law.regions.size();
  return result;
}

}  // namespace polyfly
