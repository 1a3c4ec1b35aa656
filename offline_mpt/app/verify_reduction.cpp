#include "verify_reduction.hpp"

#include <cstdio>

#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "signals.hpp"

namespace polyfly {

ReductionReport proveReduction(const RegionMap& reduced, const RegionMap& original, int threads, bool quiet,
                               bool certificate) {
  Progress progress(quiet);
  ReductionOptions options;
  options.threads = threads;
  options.certificate = certificate;
  options.progress = [&progress](std::uint64_t done, std::uint64_t total) {
    const double remaining =
        done > 0 ? progress.elapsed() * static_cast<double>(total - done) / static_cast<double>(done) : -1.0;
    progress.show("proof: " + std::to_string(done) + " of " + std::to_string(total) + " regions", remaining);
  };
  return verifyReduction(reduced, original, options);
}

ExitCode verifyReducedMap(const VerifyReductionOptions& options) {
  checkOutputs({{options.json}, {options.certificate}}, {options.map, options.original});
  endOnSignal(options.map + ": interrupted: nothing is proven");
  const RegionMap reduced = RegionMap::open(options.map);
  const RegionMap original = RegionMap::open(options.original);
  const ReductionReport report =
      proveReduction(reduced, original, options.threads, options.quiet, !options.certificate.empty());
  ignoreSignals();
  if (!options.json.empty()) writeText(options.json, reductionJson(report));
  if (!options.certificate.empty() && report.passed()) writeCertificate(report, options.certificate);
  if (!options.quiet) std::fputs(reductionText(report).c_str(), stdout);
  return report.passed() ? ExitCode::kDone : ExitCode::kFailed;
}

}  // namespace polyfly
