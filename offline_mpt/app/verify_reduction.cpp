#include "offline_mpt/verify_reduction.hpp"

#include <cstdio>

#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "signals.hpp"
#include "verify_exact.hpp"

namespace polyfly {

ExitCode verifyReducedMap(const VerifyArguments& options) {
  checkOutputs({{options.json}, {options.certificate}}, {options.map, options.reduced_from});
  endOnSignal(options.map + ": interrupted: nothing is proven");
  const RegionMap reduced = RegionMap::open(options.map);
  const RegionMap original = RegionMap::open(options.reduced_from);
  ReductionReport report;
  {
    Progress progress(options.quiet);
    ReductionOptions proof;
    proof.threads = options.verify.threads;
    proof.certificate = !options.certificate.empty();
    proof.progress = progress.counter("proof: ", " regions");
    report = verifyReduction(reduced, original, proof);
  }
  ignoreSignals();
  if (!options.json.empty()) writeText(options.json, reductionJson(report));
  if (!options.certificate.empty() && report.passed()) writeCertificate(report, options.certificate);
  if (!options.quiet) std::fputs(reductionText(report).c_str(), stdout);
  return report.passed() ? ExitCode::kDone : ExitCode::kFailed;
}

}  // namespace polyfly
