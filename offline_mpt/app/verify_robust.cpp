#include <cstdio>
#include <nlohmann/json.hpp>

#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"
#include "robust_mpc/prove_map.hpp"
#include "verify_exact.hpp"

namespace polyfly {
namespace {

ExitCode sample(const RegionMap& map, const RobustProblem& problem, const VerifyArguments& options) {
  const RobustSampling report =
      sampleRobustMap(map, problem, options.verify.samples, options.verify.seed, options.verify.tolerance);
  const bool passed = report.passed() && map.solverStatus() == "complete";
  if (!options.json.empty()) {
    nlohmann::ordered_json json;
    json["result"] = passed ? "PASSED" : "FAILED";
    json["samples"] = report.samples;
    json["seed"] = options.verify.seed;
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
        static_cast<unsigned long long>(options.verify.seed), static_cast<unsigned long long>(report.inside),
        static_cast<unsigned long long>(report.status_differs), report.input_error, report.peak_error,
        options.verify.tolerance, static_cast<unsigned long long>(report.wrong));
  }
  return passed ? ExitCode::kDone : ExitCode::kFailed;
}

}  // namespace

ExitCode verifyRobust(const RegionMap& map, const VerifyArguments& options) {
  if (!options.output.empty()) throw Error(map.path() + ": of a robust MPC there is no --repair");
  const RobustProblem problem = options.problem.empty() ? parseRobustProblem(std::string(map.problemText()),
                                                                             map.path() + ": problem text")
                                                        : loadRobustProblem(options.problem);
  if (!options.exact) return sample(map, problem, options);
  if (!options.certificate.empty() && problem.text != map.problemText())
    throw Error(map.path() + ": the problem text that it carries is not that of the problem " + problem.name +
                ", so there is no certificate");
  ProveOptions prove;
  prove.threads = options.verify.threads;
  const RobustProof proof = proveRobustMap(map, problem, prove);
  if (!options.json.empty()) writeText(options.json, proofJson(problem, proof));
  if (!options.quiet) std::fputs(proofText(problem, proof).c_str(), stdout);
  if (!proof.passed()) return ExitCode::kFailed;
  if (!options.certificate.empty()) writeCertificate(proof, options.certificate);
  return ExitCode::kDone;
}

}  // namespace polyfly
