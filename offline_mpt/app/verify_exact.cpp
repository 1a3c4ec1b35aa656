#include "verify_exact.hpp"

#include <algorithm>
#include <atomic>
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

/// Progress on the terminal; ends the work at a signal, which the time limit is too.
class Watch {
 public:
  explicit Watch(const VerifyExactOptions& options) : progress_(options.quiet) {}

  const std::atomic<bool>& stop() const { return stop_; }

  void look(std::uint64_t done, std::uint64_t total) {
    if (stopRequested()) stop_ = true;
    const std::uint64_t regions = std::max<std::uint64_t>(1, total / 3);
    const std::uint64_t part = std::min<std::uint64_t>(2, done / regions);
    static constexpr const char* kParts[] = {"conditions of ", "facets of ", "look-ups of "};
    progress_.show(kParts[part] + std::to_string(done - part * regions) + " of " + std::to_string(regions) +
                   " regions");
  }

 private:
  Progress progress_;
  std::atomic<bool> stop_{false};
};

CertifyOptions watched(const VerifyExactOptions& options, Watch& watch) {
  CertifyOptions result;
  result.threads = options.threads;
  result.stop = &watch.stop();
  result.progress = [&watch](std::uint64_t done, std::uint64_t total) { watch.look(done, total); };
  return result;
}

CertifyReport certifyFile(const VerifyExactOptions& options, const std::string& map,
                          const ParametricProgram& program, ProcessGroup* group = nullptr) {
  Watch watch(options);
  CertifyOptions choices = watched(options, watch);
  choices.group = group;
  const std::string file = options.problem.empty() ? map + ": problem text" : options.problem;
  return inFile(file, program, [&] { return certify(RegionMap::open(map), program, choices); });
}

ParametricProgram programOf(const VerifyExactOptions& options, const RegionMap& map) {
  if (!options.problem.empty()) return loadCompleteProgram(options.problem);
  return parseProgram(std::string(map.problemText()), std::string(map.problemKind()),
                      options.map + ": problem text");
}

JobInput readInput(const VerifyExactOptions& options) {
  JobInput input;
  const RegionMap map = RegionMap::open(options.map);
  input.own = ownSolverOf(map);
  if (input.own == nullptr) input.program = programOf(options, map);
  input.summary = "proof of the map " + hexDigits(map.checksum()) + " of " + input.kind();
  return input;
}

/// Repairs and writes the new map where that succeeds. Says what was done.
bool writeRepaired(const VerifyExactOptions& options, const ParametricProgram& program, bool& interrupted) {
  RepairResult result;
  {
    Watch watch(options);
    result = repair(RegionMap::open(options.map), program, watched(options, watch));
    interrupted = result.report.interrupted;
  }
  if (!options.quiet) {
    std::printf("repair: %llu regions added, %llu removed, %s\n",
                static_cast<unsigned long long>(result.added),
                static_cast<unsigned long long>(result.removed),
                result.report.passed() ? "complete" : "not complete: nothing was written");
  }
  if (!result.report.passed()) {
    if (!options.quiet) std::fputs(certifyText(result.report).c_str(), stdout);
    return false;
  }
  writeMap(encode(program, result.partition), options.output);
  return true;
}

ExitCode prove(const VerifyExactOptions& options, MpiSession& session) {
  std::vector<std::string> inputs = filesOfProblem(options.problem);
  inputs.push_back(options.map);
  checkOutputs({{options.certificate}, {options.json}, {options.output, Output::Kind::kFile}}, inputs);
  const JobInput input = session.readAlike([&] { return readInput(options); });
  if (input.own != nullptr) {
    session.leave();
    endOnAnySignal(options.map + ": interrupted: nothing is proven");
    VerifyTask task;
    task.problem = options.problem;
    task.json = options.json;
    task.certificate = options.certificate;
    task.output = options.output;
    task.exact = true;
    task.threads = options.threads;
    task.quiet = options.quiet;
    return input.own->verify(RegionMap::open(options.map), task);
  }
  const ParametricProgram& program = input.program;
  std::string examined = options.map;
  CertifyReport report = certifyFile(options, examined, program, session.group());
  session.leave();
  if (!report.passed() && !report.interrupted && !options.output.empty()) {
    if (!options.quiet) std::fputs(certifyText(report).c_str(), stdout);
    bool interrupted = false;
    if (!writeRepaired(options, program, interrupted))
      return interrupted ? ExitCode::kStopped : ExitCode::kFailed;
    examined = options.output;
    report = certifyFile(options, examined, program);
  } else if (report.passed() && !options.output.empty() && !options.quiet) {
    std::printf("repair: nothing to do, %s was not written\n", options.output.c_str());
  }
  SafetyVerdict safety;
  if (!report.interrupted) {
    endOnAnySignal(options.map + ": interrupted: nothing is proven");
    safety = verifySafety(program, examined);
    report.further_holds = safety.holds;
  }
  if (!options.json.empty()) writeText(options.json, safety.addTo(certifyJson(report)));
  if (!options.quiet) std::fputs((certifyText(report) + safety.text).c_str(), stdout);
  if (report.interrupted) {
    std::fprintf(stderr, "offline_mpt: %s: interrupted: not every region was looked at\n",
                 options.map.c_str());
    return ExitCode::kStopped;
  }
  if (!report.passed()) return ExitCode::kFailed;
  if (!options.certificate.empty()) writeCertificate(report, options.certificate);
  return ExitCode::kDone;
}

/// A process of an MPI launcher that is not the first: it takes part in the proof and says nothing.
void assist(VerifyExactOptions options, MpiSession& session) {
  options.quiet = true;
  const JobInput input = session.readAlike([&] { return readInput(options); });
  if (input.own != nullptr) return;  // process 0 proves it alone
  Watch watch(options);
  CertifyOptions choices = watched(options, watch);
  choices.group = session.group();
  runCertifyProcess(RegionMap::open(options.map), input.program, choices);
}

}  // namespace

ExitCode verifyExact(const VerifyExactOptions& options) {
  MpiSession session;
  stopOnSignal(NextSignal::kEnds, options.time_limit);
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
