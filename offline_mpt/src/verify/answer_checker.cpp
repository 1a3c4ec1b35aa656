#include "verify/answer_checker.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "polyfly_base/error.hpp"
#include "verify/exact_sample.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {

using Kind = SampleFinding::Kind;
using Verdict = StrictAnswer::Verdict;

namespace {

/// A program without variables, feasible in the region.
ParametricProgram regionAlone(const RegionMap& map, std::uint32_t index) {
  const RegionView region = map.region(index);
  const auto p = static_cast<Eigen::Index>(map.parameters().size());
  ParametricProgram program;
  program.parameters = map.parameters();
  program.A_theta.resize(region.row_count, p);
  program.b_theta.resize(region.row_count);
  for (std::uint32_t i = 0; i < region.row_count; ++i) {
    const double sign = region.rows[i] > 0 ? 1.0 : -1.0;
    const double* plane = map.plane(static_cast<std::size_t>(std::abs(region.rows[i])) - 1);
    program.A_theta.row(i) = sign * Eigen::Map<const Eigen::RowVectorXd>(plane, p);
    program.b_theta[i] = sign * plane[p];
  }
  return program;
}

}  // namespace

AnswerChecker::AnswerChecker(const RegionMap& map, const ParametricProgram& program,
                             const Eigen::VectorXd& ranges, const AnswerRules& rules)
    : map_(map),
      program_(program),
      ranges_(ranges),
      rules_(rules),
      precision_(tolerance::kCheckedRow * rules.error * ranges),
      optimum_(program, Convexity::kAsGiven) {
  if (optimum_.definite()) return;
  if (!program.H.isZero(0.0))
    throw Error(program.name + ": H is neither zero nor positive definite where the equalities hold");
  optimum_ = StrictQp(program, Convexity::kShortest);
  feasible_.emplace(program, Convexity::kFeasibility);
}

SampleFinding AnswerChecker::check(const Eigen::VectorXd& theta) {
  SampleFinding finding;
  finding.u.resize(program_.inputCount());
  finding.lookup = map_.evaluate(theta.data(), finding.u.data());
  if (finding.lookup.status == LookupStatus::kInside) {
    checkAnswer(theta, finding);
    const bool is_fault = finding.kind == Kind::kWrong || finding.kind == Kind::kFalseInside;
    if (is_fault && isRightInRegion(theta, finding)) finding.kind = Kind::kBeyond;
  } else {
    finding.kind = kindOfSilence(theta);
  }
  return finding;
}

bool AnswerChecker::isRightInRegion(const Eigen::VectorXd& theta, const SampleFinding& finding) {
  if (!map_.contains(finding.lookup.region, theta.data())) return false;
  const ParametricProgram region = regionAlone(map_, finding.lookup.region);
  const auto nearest = ExactSample(region, theta).nearestFeasible();
  if (!nearest || nearest->distance == 0.0) return false;
  SampleFinding inside = finding;
  const Eigen::Index p = theta.size();
  const double* law = map_.law(finding.lookup.law);
  for (Eigen::Index k = 0; k < inside.u.size(); ++k, law += p + 1)
    inside.u[k] = Eigen::Map<const Eigen::VectorXd>(law, p).dot(nearest->theta) + law[p];
  checkAnswer(nearest->theta, inside);
  return inside.kind == Kind::kRight || inside.kind == Kind::kEdge;
}

void AnswerChecker::checkAnswer(const Eigen::VectorXd& theta, SampleFinding& finding) {
  const RegionView region = map_.region(finding.lookup.region);
  std::vector<int> active;
  for (std::uint32_t i = 0; i < region.active_count; ++i) {
    if (region.active[i] >= 0 && region.active[i] < program_.rowCount()) active.push_back(region.active[i]);
  }
  const StrictAnswer answer = optimum_.solve(theta, active, precision_);
  const auto compare = [&](const Eigen::VectorXd& right) {
    finding.right = right;
    finding.error = (finding.u - right).cwiseAbs().cwiseQuotient(ranges_).maxCoeff();
    finding.kind = finding.error <= rules_.error ? Kind::kRight : Kind::kWrong;
  };
  finding.kind = Kind::kUndecided;
  if (answer.verdict == Verdict::kOptimal) compare(answer.u);
  const bool has_none = answer.verdict == Verdict::kInfeasible;
  if (finding.kind == Kind::kRight || (isStrict() && !has_none)) return;
  const ExactSample exact(program_, theta);
  switch (exact.status()) {
    case ExactLp::Status::kUndefined:
      return;
    case ExactLp::Status::kInfeasible:
      return decideInfeasible(theta, finding);
    case ExactLp::Status::kUnbounded:
      finding.kind = Kind::kUnbounded;
      return;
    case ExactLp::Status::kOptimal:
      if (!isStrict()) compare(exact.nearestOptimum(finding.u, ranges_));
      return;
  }
}

void AnswerChecker::decideInfeasible(const Eigen::VectorXd& theta, SampleFinding& finding) {
  finding.error = distanceToFeasible(theta);
  finding.kind = finding.error <= rules_.edge ? Kind::kEdge : Kind::kFalseInside;
}

Kind AnswerChecker::kindOfSilence(const Eigen::VectorXd& theta) {
  if (rules_.silence == Silence::kIgnored) return Kind::kOutside;
  if (rules_.silence == Silence::kQuick && isInfeasible(theta)) return Kind::kOutside;
  const ExactLp::Status status = ExactSample(program_, theta).status();
  if (status == ExactLp::Status::kInfeasible) return Kind::kOutside;
  if (isAtEdge(theta)) return Kind::kEdge;
  return status == ExactLp::Status::kUnbounded ? Kind::kUnbounded : Kind::kMissed;
}

bool AnswerChecker::isInfeasible(const Eigen::VectorXd& theta) {
  StrictQp& qp = feasible_ ? *feasible_ : optimum_;
  return qp.solve(theta, {}, precision_).verdict == Verdict::kInfeasible;
}

bool AnswerChecker::isAtEdge(const Eigen::VectorXd& theta) {
  if (isInfeasible(theta)) return distanceToFeasible(theta) <= rules_.edge;
  return anyBeside(theta, program_.parameters, rules_.edge,
                   [&](const Eigen::VectorXd& at) { return isInfeasible(at); });
}

// At most, where it is less than the edge. Beside a corner of the feasible set, no axis may lead there.
double AnswerChecker::distanceToFeasible(const Eigen::VectorXd& theta) {
  const auto isFeasible = [&](const Eigen::VectorXd& at) { return !isInfeasible(at); };
  if (anyBeside(theta, program_.parameters, rules_.edge, isFeasible)) return rules_.edge;
  const auto nearest = ExactSample(program_, theta).nearestFeasible();
  return nearest ? nearest->distance : std::numeric_limits<double>::infinity();
}

Eigen::VectorXd inputRanges(const RegionMap& map, const std::vector<Eigen::VectorXd>& samples) {
  const auto q = static_cast<Eigen::Index>(map.inputs().size());
  Eigen::VectorXd ranges = Eigen::VectorXd::Constant(q, tolerance::kNoOutput), u(q);
  for (const Eigen::VectorXd& theta : samples) {
    if (map.evaluate(theta.data(), u.data()).status == LookupStatus::kInside)
      ranges = ranges.cwiseMax(u.cwiseAbs());
  }
  for (Eigen::Index k = 0; k < q; ++k) {
    const Signal& signal = map.inputs()[static_cast<std::size_t>(k)];
    const double range = signal.upper - signal.lower;
    if (range > 0.0 && range < tolerance::kNoRange) ranges[k] = range;
  }
  return ranges;
}

}  // namespace polyfly
