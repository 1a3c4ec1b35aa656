#include "verify_robust.hpp"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"
#include "robust_mpc/prove_map.hpp"

namespace polyfly {
namespace {

ExitCode sample(const RegionMap& map, const RobustProblem& problem, const VerifyRobustOptions& options) {
  const RobustSampling report =
      sampleRobustMap(map, problem, options.samples, options.seed, options.tolerance);
  const bool passed = report.passed() && map.solverStatus() == "complete";
  if (!options.json.empty()) {
    nlohmann::ordered_json json;
    json["result"] = passed ? "PASSED" : "FAILED";
    json["samples"] = report.samples;
    json["seed"] = options.seed;
    json["inside"] = report.inside;
    json["status_differs"] = report.status_differs;
    json["wrong"] = report.wrong;
    json["input_error"] = report.input_error;
    json["peak_error"] = report.peak_error;
    writeText(options.json, json.dump(2) + "\n");
  }
  if (!options.quiet) {
    std::printf(
        "%s\n  samples %llu (seed %llu), feasible %llu\n  feasible for one of map and linear program only: "
        "%llu\n  greatest error: input %.3g, tau %.3g; beyond the tolerance %.3g: %llu\n",
        passed ? "PASSED" : "FAILED", static_cast<unsigned long long>(report.samples),
        static_cast<unsigned long long>(options.seed), static_cast<unsigned long long>(report.inside),
        static_cast<unsigned long long>(report.status_differs), report.input_error, report.peak_error,
        options.tolerance, static_cast<unsigned long long>(report.wrong));
  }
  return passed ? ExitCode::kDone : ExitCode::kFailed;
}

}  // namespace

bool isRobustMap(const RegionMap& map) {
  return map.problemKind() == "yaml" && !map.problemText().empty() &&
         isRobustProblem(std::string(map.problemText()), map.path() + ": problem text");
}

ExitCode verifyRobust(const RegionMap& map, const VerifyRobustOptions& options) {
  const RobustProblem problem = options.problem.empty() ? parseRobustProblem(std::string(map.problemText()),
                                                                             map.path() + ": problem text")
                                                        : loadRobustProblem(options.problem);
  if (!options.exact) return sample(map, problem, options);
  ProveOptions prove;
  prove.threads = options.threads;
  const RobustProof proof = proveRobustMap(map, problem, prove);
  if (!options.json.empty()) writeText(options.json, proofJson(problem, proof));
  if (!options.quiet) std::fputs(proofText(problem, proof).c_str(), stdout);
  return proof.passed() ? ExitCode::kDone : ExitCode::kFailed;
}

}  // namespace polyfly
