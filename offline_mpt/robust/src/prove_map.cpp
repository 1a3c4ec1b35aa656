#include "robust_mpc/prove_map.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "polyfly_base/error.hpp"
#include "rational_parts.hpp"
#include "region_maps/region_map.hpp"
#include "robust_certificate.hpp"
#include "robust_mpc/online_lp.hpp"
#include "verify/same_signals.hpp"

namespace polyfly {
namespace {

/// Planes and laws as they are written, coverage facet by facet, and look-ups.
void certifyLaw(const RegionMap& map, const RobustStatement& statement, const ProveOptions& options,
                RobustProof& proof) {
  CertifyOptions certify;
  certify.threads = options.threads;
  certify.stop = options.stop;
  CertifyReport report = certifyRobust(map, statement, certify);
  if (report.interrupted) throw Error(map.path() + ": stopped before all was proven");
  for (const Defect& defect : report.defects) proof.defects.push_back(defect.text);
  proof.law_error = report.law_error;
  proof.plane_error = report.plane_error;
  proof.certificate = std::move(report.certificate);
}

}  // namespace

RobustProof proveRobustMap(const RegionMap& map, const RobustProblem& problem, const ProveOptions& options) {
  if (map.reducedFrom() != 0)
    throw Error(map.path() +
                ": is a reduced map: prove the one that it was made from, and then --reduced-from");
  const RobustProgram program = buildRobustProgram(problem);
  ProjectOptions project;
  project.threads = options.threads;
  project.stop = options.stop;
  const FeasibleSet set = projectFeasibleSet(program, project);
  if (set.interrupted) throw Error(map.path() + ": stopped before anything was proven");
  const RobustLaw law = explicitLaw(problem, set);
  const RoundedLaw rounded = roundLaw(problem, law, ExploreStatus::kComplete);
  requireSameSignals(map, rounded.program);
  RobustProof proof = proveLaw(problem, program, set, law);
  if (map.solverStatus() != "complete") proof.defects.push_back("the map says that it is not complete");
  if (proof.lawHolds()) certifyLaw(map, {problem, program, set, law, rounded.program}, options, proof);
  return proof;
}

RobustSampling sampleRobustMap(const RegionMap& map, const RobustProblem& problem, std::uint64_t samples,
                               std::uint64_t seed, double tolerance) {
  requireSameSignals(map, roundLaw(problem, {}, ExploreStatus::kComplete).program);
  OnlineLp online(problem);
  std::mt19937_64 engine(seed);
  RobustSampling result;
  const int np = problem.parameterCount();
  Eigen::VectorXd theta(np);
  std::vector<double> output(map.inputs().size());
  for (std::uint64_t k = 0; k < samples; ++k) {
    double reference = 0.0;
    for (int j = 0; j < np; ++j) {
      const RobustProblem::Parameter& parameter = problem.parameters[at(j)];
      const double share = static_cast<double>(engine() >> 11U) * 0x1p-53;
      theta[j] = parameter.signal.lower + share * (parameter.signal.upper - parameter.signal.lower);
      if (parameter.state < 0) reference += nearestDouble(parameter.input_shift[0]) * theta[j];
    }
    ++result.samples;
    const OnlineLp::Answer answer = online.solve(theta);
    const bool inside = map.evaluate(theta.data(), output.data()).status == LookupStatus::kInside;
    if (inside != answer.feasible) {
      ++result.status_differs;
      continue;
    }
    if (!inside) continue;
    ++result.inside;
    const double input = answer.input + reference;
    double error = std::abs(output[0] - input) / std::max(1.0, std::abs(input));
    result.input_error = std::max(result.input_error, error);
    if (problem.peak_in_map) {
      result.peak_error = std::max(result.peak_error, std::abs(output[1] - answer.peak));
      error = std::max(error, std::abs(output[1] - answer.peak));
    }
    if (error > tolerance) ++result.wrong;
  }
  return result;
}

}  // namespace polyfly
