#include "verify/self_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "offline_mpt/partition.hpp"
#include "region_maps/map_image.hpp"
#include "region_maps/region_map.hpp"
#include "support/in_parallel.hpp"
#include "support/vector_text.hpp"
#include "verify/answer_checker.hpp"
#include "verify/parameter_sampler.hpp"
#include "verify/tolerances.hpp"

namespace polyfly {
namespace {

using Kind = SampleFinding::Kind;

constexpr std::uint64_t kLeastSamples = 200;
constexpr std::uint64_t kRegionsPerSample = 50;
constexpr std::uint64_t kCheckSeed = 1;

std::vector<Eigen::VectorXd> checkSamples(const RegionMap& map) {
  const std::uint64_t regions = map.regionCount();
  const std::uint64_t count = kLeastSamples + regions / kRegionsPerSample;
  ParameterSampler sampler(map, kCheckSeed, 0);
  std::vector<Eigen::VectorXd> samples;
  for (std::uint64_t i = 0; samples.size() < count; ++i) {
    samples.push_back(sampler.uniform().theta);
    // Regions at equal distances in the list, all where they are few.
    const std::uint64_t region = regions <= count / 3 ? i % regions : (i * 3 * regions / count) % regions;
    const ParameterSampler::Sample centre = sampler.centre(region);
    if (!(centre.radius > 0.0)) continue;
    samples.push_back(centre.theta);
    if (Eigen::VectorXd behind = sampler.behindFacet(); behind.size() > 0)
      samples.push_back(std::move(behind));
  }
  return samples;
}

/// What is wrong in words; empty where nothing is.
std::string faultOf(const SampleFinding& finding, const Eigen::VectorXd& theta) {
  const std::string at = " theta = " + vectorText(theta);
  const bool is_inside = finding.lookup.status == LookupStatus::kInside;
  const std::string place =
      is_inside ? "region " + std::to_string(finding.lookup.region) + " at" + at : "no region holds" + at;
  char share[32];
  switch (finding.kind) {
    case Kind::kRight:
    case Kind::kOutside:
    case Kind::kEdge:
    case Kind::kBeyond:
      return "";
    case Kind::kWrong:
      std::snprintf(share, sizeof share, "%.3g", finding.error);
      return place + ": u is off by " + share + " of the input's range, u = " + vectorText(finding.u) +
             ", right is " + vectorText(finding.right);
    case Kind::kMissed:
      return place + ", which is feasible";
    case Kind::kFalseInside:
      return place + ": it answers, but the program is infeasible";
    case Kind::kUnbounded:
      return place + ": the cost is unbounded below";
    case Kind::kUndecided:
      return place + ": the optimum could not be found";
  }
  return "";
}

/// The first of the worst faults counts.
AnswerCheck summary(const std::vector<Eigen::VectorXd>& samples, const std::vector<SampleFinding>& findings) {
  AnswerCheck result;
  result.samples = findings.size();
  double worst_fault = -1.0;
  for (std::size_t i = 0; i < findings.size(); ++i) {
    const SampleFinding& finding = findings[i];
    const bool is_of_input = finding.kind == Kind::kRight || finding.kind == Kind::kWrong;
    const double error = is_of_input ? finding.error : 0.0;
    result.worst = std::max(result.worst, error);
    if (!(error > worst_fault)) continue;
    const std::string fault = faultOf(finding, samples[i]);
    if (fault.empty()) continue;
    worst_fault = error;
    result.fault = fault;
  }
  return result;
}

}  // namespace

AnswerCheck checkAnswers(const RegionMap& map, const ParametricProgram& program,
                         const AnswerCheckOptions& options) {
  const std::vector<Eigen::VectorXd> samples = checkSamples(map);
  const Eigen::VectorXd ranges = inputRanges(map, samples);
  const bool is_complete = map.solverStatus() == toString(ExploreStatus::kComplete);
  const AnswerRules rules = {tolerance::kCheckedError, tolerance::kCheckedEdge,
                             is_complete ? Silence::kQuick : Silence::kIgnored};
  const int threads = std::clamp(options.threads, 1, 256);
  std::vector<AnswerChecker> checkers(static_cast<std::size_t>(threads),
                                      AnswerChecker(map, program, ranges, rules));
  std::vector<SampleFinding> findings(samples.size());
  inParallel(samples.size(), threads, options.stop, options.progress,
             [&](std::size_t thread, std::uint64_t i) { findings[i] = checkers[thread].check(samples[i]); });
  return summary(samples, findings);
}

AnswerCheck checkAnswers(const MapContent& content, const ParametricProgram& program,
                         const AnswerCheckOptions& options) {
  return checkAnswers(MapImage(content).view(content.name), program, options);
}

AnswerCheck checkAnswers(const MapContent& content,
                         const std::function<std::optional<double>(const double* theta)>& first_input) {
  const MapImage image(content);
  const RegionMap map = image.view(content.name);
  const std::vector<Eigen::VectorXd> samples = checkSamples(map);
  const double range = inputRanges(map, samples)[0];
  const auto is_at_edge = [&](const Eigen::VectorXd& theta, bool has_answer) {
    return anyBeside(theta, map.parameters(), tolerance::kCheckedEdge, [&](const Eigen::VectorXd& at) {
      return first_input(at.data()).has_value() != has_answer;
    });
  };
  std::vector<SampleFinding> findings;
  for (const Eigen::VectorXd& theta : samples) {
    SampleFinding finding;
    finding.u.resize(static_cast<Eigen::Index>(map.inputs().size()));
    finding.lookup = map.evaluate(theta.data(), finding.u.data());
    const bool is_inside = finding.lookup.status == LookupStatus::kInside;
    const std::optional<double> right = first_input(theta.data());
    if (is_inside && right) {
      finding.right = finding.u;
      finding.right[0] = *right;
      finding.error = std::abs(finding.u[0] - *right) / range;
      finding.kind = finding.error <= tolerance::kCheckedError ? Kind::kRight : Kind::kWrong;
    } else if (is_inside != right.has_value()) {
      finding.kind = is_at_edge(theta, right.has_value()) ? Kind::kEdge
                     : is_inside                          ? Kind::kFalseInside
                                                          : Kind::kMissed;
    } else {
      finding.kind = Kind::kOutside;
    }
    findings.push_back(std::move(finding));
  }
  return summary(samples, findings);
}

}  // namespace polyfly
