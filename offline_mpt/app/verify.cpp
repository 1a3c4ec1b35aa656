#include "offline_mpt/verify.hpp"

#include <cstdio>
#include <memory>

#include "command.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/read_problem.hpp"
#include "progress.hpp"
#include "signals.hpp"
#include "verify_exact.hpp"
#include "verify_reduction.hpp"
#include "verify_robust.hpp"

namespace polyfly {
namespace {

const char kFooter[] =
    "Half of the samples are uniform in the parameters' box; the others lie on, beside or at the meeting of "
    "faces\n"
    "of random regions and at their centres. Each is solved by an interior-point method that shares no code "
    "with\n"
    "the solver. Where the minimiser is not unique (H singular), the objective that the map's input admits "
    "is\n"
    "compared instead of the input; the report says so. The report depends on the map, the problem, "
    "--samples and\n"
    "--seed only.\n"
    "\n"
    "The result is PASSED (exit code 0) when no sample breaks a rule, all were decided and the map says that "
    "it is\n"
    "complete.\n"
    "\n"
    "Examples:\n"
    "  offline_mpt verify lateral.map --problem multirotor_lateral.yaml --samples 100000 --seed 1\n"
    "  offline_mpt verify lateral.map --exact --certificate lateral.cert    (a proof; see CERTIFICATE.md)\n"
    "  offline_mpt verify lateral.map --exact --repair -o repaired.map\n"
    "  offline_mpt verify small.map --reduced-from lateral.map --certificate small.cert    (a proof; see "
    "reduce "
    "--help)\n"
    "  offline_mpt verify lateral.map --json report.json    (against the problem that the map carries)";

struct Options {
  std::string map;
  std::string problem;
  std::string json;
  VerifyOptions verify;
  bool quiet = false;
  bool exact = false;
  bool repair = false;
  std::string certificate;
  std::string reduced_from;
  std::string output;
  double time_limit = 0.0;
};

ExitCode verifyMap(const Options& options) {
  std::vector<std::string> inputs = filesOfProblem(options.problem);
  inputs.push_back(options.map);
  checkOutputs({{options.json}}, inputs);
  const RegionMap map = RegionMap::open(options.map);
  if (isRobustMap(map)) {
    return verifyRobust(map,
                        {options.problem, options.json, false, options.verify.samples, options.verify.seed,
                         options.verify.tolerance, options.verify.threads, options.quiet});
  }
  const ParametricProgram program =
      options.problem.empty() ? parseProgram(std::string(map.problemText()), std::string(map.problemKind()),
                                             options.map + ": problem text")
                              : loadProgram(options.problem);
  VerifyOptions verify_options = options.verify;
  verify_options.stop = &stopOnSignal();
  VerifyReport report;
  {
    Progress progress(options.quiet);
    verify_options.progress = [&](std::uint64_t done, std::uint64_t total) {
      const double remaining =
          done > 0 ? progress.elapsed() * static_cast<double>(total - done) / static_cast<double>(done)
                   : -1.0;
      progress.show(std::to_string(done) + " of " + std::to_string(total) + " samples", remaining);
    };
    report = verify(map, program, verify_options);
  }
  if (!options.json.empty()) writeText(options.json, verifyJson(report));
  if (!options.quiet) std::fputs(verifyText(report).c_str(), stdout);
  if (report.interrupted) {
    std::fprintf(stderr, "offline_mpt: %s: interrupted: the report covers %llu of %llu samples\n",
                 options.map.c_str(), static_cast<unsigned long long>(report.samples),
                 static_cast<unsigned long long>(report.requested));
    return ExitCode::kStopped;
  }
  return report.passed() ? ExitCode::kDone : ExitCode::kFailed;
}

void addExact(CLI::App* command, const std::shared_ptr<Options>& options) {
  CLI::Option* exact = command->add_flag(
      "--exact", options->exact, "prove the map in rational arithmetic instead of sampling, or refute it");
  for (const char* sampling : {"--samples", "--seed", "--tolerance"})
    exact->excludes(command->get_option(sampling));
  command->add_option("--certificate", options->certificate,
                      "with --exact or --reduced-from: write the proof, for check_certificate");
  CLI::Option* repair =
      command->add_flag("--repair", options->repair, "with --exact: add what is missing, into a new map")
          ->needs(exact);
  CLI::Option* output = command->add_option("-o,--output", options->output, "with --repair: the new map");
  output->needs(repair);
  repair->needs(output);
  command->add_option("--time-limit", options->time_limit, "with --exact: stop after so long [s]")
      ->check(numberAbove(0.0))
      ->needs(exact);
  CLI::Option* reduced =
      command->add_option("--reduced-from", options->reduced_from,
                          "prove in rational arithmetic that MAP, made by `reduce`, answers "
                          "as this map does");
  reduced->excludes(exact);
  for (const char* other : {"--problem", "--samples", "--seed", "--tolerance"})
    reduced->excludes(command->get_option(other));
}

}  // namespace

void addVerify(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<Options>();
  options->verify.threads = defaultThreads();
  CLI::App* command = app.add_subcommand("verify", "Compare a map with direct solutions of its problem");
  command->footer(kFooter);
  command->add_option("MAP", options->map, "map file")->required();
  command->add_option("--problem", options->problem,
                      "problem file (default: the problem that the map carries)");
  command->add_option("--samples", options->verify.samples, "parameters to try")
      ->check(wholeNumber<std::uint64_t>(1))
      ->capture_default_str();
  command->add_option("--seed", options->verify.seed, "of the generator")
      ->check(wholeNumber<std::uint64_t>())
      ->capture_default_str();
  command
      ->add_option("--tolerance", options->verify.tolerance,
                   "greatest error of the input, relative to max(1, |u|)")
      ->check(numberAbove(0.0))
      ->capture_default_str();
  command->add_option("--threads", options->verify.threads, "worker threads (default: all processors)")
      ->check(wholeNumber(1, 256));
  command->add_option("--json", options->json, "write the report as JSON");
  command->add_flag("--quiet", options->quiet, "say nothing: the exit code is the answer");
  addExact(command, options);
  command->callback([options, &exit_code] {
    if (!options->reduced_from.empty()) {
      exit_code = verifyReducedMap({options->map, options->reduced_from, options->json, options->certificate,
                                    options->verify.threads, options->quiet});
      return;
    }
    if (!options->certificate.empty() && !options->exact)
      throw CLI::ValidationError("--certificate requires --exact or --reduced-from");
    exit_code =
        options->exact
            ? verifyExact({options->map, options->problem, options->certificate, options->json,
                           options->output, options->verify.threads, options->quiet, options->time_limit})
            : verifyMap(*options);
  });
}

}  // namespace polyfly
