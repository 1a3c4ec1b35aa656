#include "verify_reduction.hpp"

#include <cstdio>

#include "region_maps/region_map.hpp"
#include "signals.hpp"

namespace polyfly {

void showProof(Progress& progress, std::uint64_t done, std::uint64_t total) {
  progress.show("proof: " + std::to_string(done) + " of " + std::to_string(total) + " regions");
}

ExitCode verifyReducedMap(const VerifyReductionOptions& options) {
  checkOutputs({{options.json}, {options.certificate}}, {options.map, options.original});
  endOnSignal(options.map + ": interrupted: nothing is proven");
  const RegionMap reduced = RegionMap::open(options.map);
  const RegionMap original = RegionMap::open(options.original);
  ReductionReport report;
  {
    Progress progress(options.quiet);
    ReductionOptions proof;
    proof.threads = options.threads;
    proof.certificate = !options.certificate.empty();
    proof.progress = [&progress](std::uint64_t done, std::uint64_t total) {
      showProof(progress, done, total);
    };
    report = verifyReduction(reduced, original, proof);
  }
  ignoreSignals();
  if (!options.json.empty()) writeText(options.json, reductionJson(report));
  if (!options.certificate.empty() && report.passed()) writeCertificate(report, options.certificate);
  if (!options.quiet) std::fputs(reductionText(report).c_str(), stdout);
  return report.passed() ? ExitCode::kDone : ExitCode::kFailed;
}

}  // namespace polyfly
