#include "verify_exact.hpp"

#include <algorithm>
#include <cstdio>

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/read_problem.hpp"
#include "mpi_session.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/process_group.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/provenance.hpp"
#include "problem_types.hpp"
#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "safety_filter/safe_set.hpp"
#include "signals.hpp"
#include "verify_safety.hpp"

namespace polyfly {
namespace {

CertifyOptions watched(const VerifyArguments& options, Progress& progress) {
  CertifyOptions result;
  result.threads = options.verify.threads;
  result.progress = [&progress](std::uint64_t done, std::uint64_t total) {
    const std::uint64_t regions = std::max<std::uint64_t>(1, total / 3);
    const std::uint64_t part = std::min<std::uint64_t>(2, done / regions);
    static constexpr const char* kParts[] = {"conditions of ", "facets of ", "look-ups of "};
    progress.show(kParts[part] + std::to_string(done - part * regions) + " of " + std::to_string(regions) +
                  " regions");
  };
  return result;
}

CertifyReport certifyFile(const VerifyArguments& options, const std::string& map,
                          const ParametricProgram& program, ProcessGroup* group = nullptr) {
  Progress progress(options.quiet);
  CertifyOptions choices = watched(options, progress);
  choices.group = group;
  const std::string file = options.problem.empty() ? map + ": problem text" : options.problem;
  return inFile(file, program, [&] { return certify(RegionMap::open(map), program, choices); });
}

JobInput readInput(const VerifyArguments& options) {
  JobInput input;
  const RegionMap map = RegionMap::open(options.map);
  input.own = ownSolverOf(map);
  if (input.own == nullptr) input.program = programOf(options, map);
  input.summary = "proof of the map " + hexDigits(map.checksum()) + " of " + input.kind();
  return input;
}

/// Repairs and writes the new map where that succeeds. Says what was done.
bool writeRepaired(const VerifyArguments& options, const ParametricProgram& program) {
  Progress progress(options.quiet);
  const RepairResult result = repair(RegionMap::open(options.map), program, watched(options, progress));
  progress.finish();
  const bool passed = result.report.passed();
  if (!options.quiet) {
    std::printf("repair: %llu regions added, %llu removed, %s\n",
                static_cast<unsigned long long>(result.added),
                static_cast<unsigned long long>(result.removed),
                passed ? "complete" : "not complete: nothing was written");
    if (!passed) std::fputs(certifyText(result.report).c_str(), stdout);
  }
  if (passed) writeMap(encode(program, result.partition), options.output);
  return passed;
}

ExitCode prove(const VerifyArguments& options, MpiSession& session) {
  std::vector<std::string> inputs = filesOfProblem(options.problem);
  inputs.push_back(options.map);
  checkOutputs({{options.certificate}, {options.json}, {options.output, Output::Kind::kFile}}, inputs);
  endOnSignal(options.map + ": interrupted: nothing is proven", options.time_limit);
  const JobInput input = session.readAlike([&] { return readInput(options); });
  if (input.own != nullptr) {
    session.leave();
    return input.own->verify(RegionMap::open(options.map), options);
  }
  const ParametricProgram& program = input.program;
  std::string examined = options.map;
  CertifyReport report = certifyFile(options, examined, program, session.group());
  session.leave();
  if (!report.passed() && !options.output.empty()) {
    if (!options.quiet) std::fputs(certifyText(report).c_str(), stdout);
    if (!writeRepaired(options, program)) return ExitCode::kFailed;
    examined = options.output;
    report = certifyFile(options, examined, program);
  } else if (report.passed() && !options.output.empty() && !options.quiet) {
    std::printf("repair: nothing to do, %s was not written\n", options.output.c_str());
  }
  const SafetyVerdict safety = verifySafety(program, examined);
  report.further_holds = safety.holds;
  ignoreSignals();
  if (!options.json.empty()) writeText(options.json, safety.addTo(certifyJson(report)));
  if (!options.quiet) std::fputs((certifyText(report) + safety.text).c_str(), stdout);
  if (!report.passed()) return ExitCode::kFailed;
  if (!options.certificate.empty()) writeCertificate(report, options.certificate);
  return ExitCode::kDone;
}

/// A process of an MPI launcher that is not the first: it takes part in the proof and says nothing.
void assist(const VerifyArguments& options, MpiSession& session) {
  ignoreSignals();
  const JobInput input = session.readAlike([&] { return readInput(options); });
  if (input.own != nullptr) return;  // process 0 proves it alone
  Progress progress(true);
  CertifyOptions choices = watched(options, progress);
  choices.group = session.group();
  runCertifyProcess(RegionMap::open(options.map), input.program, choices);
}

}  // namespace

ExitCode verifyExact(const VerifyArguments& options) {
  MpiSession session;
  if (!session.leads()) return session.assist([&] { assist(options, session); });
  try {
    return prove(options, session);
  } catch (const LostProcess& lost) {
    std::fprintf(stderr, "offline_mpt: %s: process %d of the MPI job was lost\n", options.map.c_str(),
                 lost.rank());
    session.abort();
    return ExitCode::kStopped;
  }
}

}  // namespace polyfly
