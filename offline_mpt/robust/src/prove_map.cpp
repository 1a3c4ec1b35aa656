#include "robust_mpc/prove_map.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>

#include "polyfly_base/error.hpp"
#include "polytope_sets/polytope.hpp"
#include "rational_parts.hpp"
#include "region_maps/region_map.hpp"
#include "robust_certificate.hpp"
#include "robust_mpc/online_lp.hpp"
#include "tolerances.hpp"
#include "verify/same_signals.hpp"

namespace polyfly {
namespace {

/// Holds a map's regions against the exact ones with the same active facets, and the other way round.
class Comparison {
 public:
  Comparison(const RegionMap& map, const RobustProblem& problem, const RobustLaw& law, RobustProof& proof)
      : map_(map), problem_(problem), law_(law), proof_(proof) {}

  void run() {
    std::map<std::vector<int>, std::size_t> by_active;
    for (std::size_t k = 0; k < law_.regions.size(); ++k) {
      std::vector<int> active = law_.regions[k].active;
      std::sort(active.begin(), active.end());
      by_active.emplace(active, k);
    }
    std::vector<char> met(law_.regions.size(), 0);
    for (std::size_t r = 0; r < map_.regionCount(); ++r) {
      const RegionView view = map_.region(r);
      const auto found = by_active.find(std::vector<int>(view.active, view.active + view.active_count));
      if (found == by_active.end() || met[found->second] != 0) {
        fail("region " + std::to_string(r) + " of the map is none of the exact ones, or there twice");
        continue;
      }
      met[found->second] = 1;
      compareRegion(r, view, law_.regions[found->second]);
    }
    for (std::size_t k = 0; k < met.size(); ++k) {
      if (met[k] == 0) fail("the map lacks exact region " + std::to_string(k));
    }
  }

 private:
  void fail(const std::string& defect) { proof_.defects.push_back(defect); }

  Rational applied(const RobustLaw::Region& region, const RationalVector& theta) const {
    Rational input = dot(region.input_gain, theta) + region.input_offset;
    for (std::size_t j = 0; j < theta.size(); ++j) {
      if (problem_.parameters[j].state < 0) input += problem_.parameters[j].input_shift[0] * theta[j];
    }
    return input;
  }

  // The map's doubles at an exact vertex, exactly.
  static Rational valueOf(const double* coefficients, const RationalVector& theta) {
    Rational sum(coefficients[theta.size()]);
    for (std::size_t j = 0; j < theta.size(); ++j) sum += Rational(coefficients[j]) * theta[j];
    return sum;
  }

  void compareRegion(std::size_t r, const RegionView& view, const RobustLaw::Region& exact) {
    const std::string name = "region " + std::to_string(r);
    double law_error = 0.0, plane_error = 0.0;
    const double* law = map_.law(view.law);
    const std::size_t width = at(problem_.parameterCount()) + 1;
    for (const RationalVector& vertex : exact.vertices) {
      law_error = std::max(law_error, std::abs(nearestDouble(valueOf(law, vertex) - applied(exact, vertex))));
      if (problem_.peak_in_map) {
        const Rational peak = dot(exact.peak_gain, vertex) + exact.peak_offset;
        law_error = std::max(law_error, std::abs(nearestDouble(valueOf(law + width, vertex) - peak)));
      }
      for (std::uint32_t k = 0; k < view.row_count; ++k)
        plane_error = std::max(plane_error, nearestDouble(excessOf(view.rows[k], vertex)));
    }
    // the map's region is no larger: each exact facet is one of its planes
    for (const ExactHalfSpace& row : exact.polytope.rows)
      plane_error = std::max(plane_error, distanceTo(view, row));
    proof_.law_error = std::max(proof_.law_error, law_error);
    proof_.plane_error = std::max(proof_.plane_error, plane_error);
    if (law_error > tolerance::kLawError) fail(name + ": law differs by " + std::to_string(law_error));
    if (plane_error > tolerance::kPlaneError)
      fail(name + ": half-spaces differ by " + std::to_string(plane_error));
  }

  Rational excessOf(std::int32_t row, const RationalVector& vertex) const {
    const double* plane = map_.plane(static_cast<std::size_t>(std::abs(row)) - 1);
    Rational sum(-plane[vertex.size()]);
    for (std::size_t j = 0; j < vertex.size(); ++j) sum += Rational(plane[j]) * vertex[j];
    return row > 0 ? sum : Rational(-sum);
  }

  // Greatest difference of coefficients, scaled, to the nearest plane of the region.
  double distanceTo(const RegionView& view, const ExactHalfSpace& row) const {
    ExactPolytope one;
    one.dimension = problem_.parameterCount();
    ExactHalfSpace scaled = row;
    for (int j = 0; j < one.dimension; ++j) {
      const RobustProblem::Range& range = problem_.parameters[at(j)].range;
      scaled.b -= row.a[at(j)] * (range.upper + range.lower) / 2;
      scaled.a[at(j)] *= (range.upper - range.lower) / 2;
    }
    one.rows.push_back(scaled);
    const Polytope unit = rounded(one);
    double least = INFINITY;
    for (std::uint32_t k = 0; k < view.row_count; ++k) {
      const double* plane = map_.plane(static_cast<std::size_t>(std::abs(view.rows[k])) - 1);
      const double sign = view.rows[k] > 0 ? 1.0 : -1.0;
      double bound = plane[one.dimension], difference = 0.0;
      for (int j = 0; j < one.dimension; ++j) {
        const Signal& signal = problem_.parameters[at(j)].signal;
        bound -= plane[j] * 0.5 * (signal.upper + signal.lower);
        difference = std::max(difference,
                              std::abs(sign * plane[j] * 0.5 * (signal.upper - signal.lower) - unit.A(0, j)));
      }
      least = std::min(least, std::max(difference, std::abs(sign * bound - unit.b[0])));
    }
    return least;
  }

  const RegionMap& map_;
  const RobustProblem& problem_;
  const RobustLaw& law_;
  RobustProof& proof_;
};

/// What the law's proof leaves: planes and laws as they are written, coverage facet by facet, and look-ups.
void addCertificate(const RegionMap& map, const RobustStatement& statement, const ProveOptions& options,
                    RobustProof& proof) {
  CertifyOptions certify;
  certify.threads = options.threads;
  certify.stop = options.stop;
  CertifyReport report = certifyRobust(map, statement, certify);
  if (report.interrupted) throw Error(map.path() + ": stopped before all was proven");
  for (const Defect& defect : report.defects) proof.defects.push_back(defect.text);
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
  Comparison(map, problem, law, proof).run();
  if (proof.passed()) addCertificate(map, {problem, program, set, law, rounded.program}, options, proof);
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
