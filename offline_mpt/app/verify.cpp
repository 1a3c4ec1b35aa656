#include "offline_mpt/verify.hpp"

#include <cstdio>
#include <memory>

#include "command.hpp"
#include "mpc_core/read_problem.hpp"
#include "problem_types.hpp"
#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "signals.hpp"
#include "verify_exact.hpp"

namespace polyfly {
namespace {

const char kVerifyFooter[] =
    R"(Half of the samples are uniform in the parameters' box. The others lie on and next to faces of random
regions, where faces meet, and at the centres of regions. At each sample the optimum is computed with 32
digits on the numbers of the problem. Exact linear programs decide where a map is silent. With H = 0 the
optimum may not be unique; the nearest one counts. The report depends only on the map, the problem,
--samples and --seed.

The result is PASSED (exit code 0) if no sample breaks a rule, all samples were decided, and the map is
marked complete.

--exact and --reduced-from give a proof instead; offline_mpt/CERTIFICATE.md explains it. With mpirun, the
processes prove together (--exact).

Examples:
  offline_mpt verify lateral.map --problem multirotor_lateral.yaml --samples 100000 --seed 1
  offline_mpt verify lateral.map --exact --certificate lateral.cert
  offline_mpt verify lateral.map --exact --repair -o repaired.map
  offline_mpt verify small.map --reduced-from lateral.map --certificate small.cert
  offline_mpt verify lateral.map --json report.json)";

ExitCode verifyMap(const VerifyArguments& options) {
  std::vector<std::string> inputs = filesOfProblem(options.problem);
  inputs.push_back(options.map);
  checkOutputs({{options.json}}, inputs);
  const RegionMap map = RegionMap::open(options.map);
  if (const OwnSolver* own = ownSolverOf(map); own != nullptr) return own->verify(map, options);
  const ParametricProgram program = programOf(options, map);
  VerifyOptions verify_options = options.verify;
  verify_options.stop = &stopOnSignal();
  VerifyReport report;
  {
    Progress progress(options.quiet);
    verify_options.progress = progress.counter("", " samples");
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

void addExact(CLI::App* command, const std::shared_ptr<VerifyArguments>& options) {
  CLI::Option* exact = command->add_flag(
      "--exact", options->exact, "Prove or refute the map in rational arithmetic instead of sampling.");
  for (const char* sampling : {"--samples", "--seed", "--tolerance"})
    exact->excludes(command->get_option(sampling));
  command->add_option("--certificate", options->certificate,
                      "With --exact or --reduced-from: write the proof to this file, for check_certificate.");
  CLI::Option* repair =
      command
          ->add_flag("--repair", options->repair, "With --exact: write a new map with the missing regions.")
          ->needs(exact);
  CLI::Option* output =
      command->add_option("-o,--output", options->output, "With --repair: the new map file.");
  output->needs(repair);
  repair->needs(output);
  command->add_option("--time-limit", options->time_limit, "With --exact: stop after this time [s].")
      ->check(numberAbove(0.0))
      ->needs(exact);
  CLI::Option* reduced = command->add_option(
      "--reduced-from", options->reduced_from,
      "Prove in rational arithmetic that MAP, written by `reduce`, answers as this map does.");
  reduced->excludes(exact);
  for (const char* other : {"--problem", "--samples", "--seed", "--tolerance"})
    reduced->excludes(command->get_option(other));
}

}  // namespace

void addVerify(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<VerifyArguments>();
  CLI::App* command =
      app.add_subcommand("verify", "Compare a map with direct solutions of its problem, or prove it.");
  command->footer(kVerifyFooter);
  command->add_option("MAP", options->map, "Map file.")->required();
  command->add_option("--problem", options->problem, "Problem file (default: the problem text in the map).");
  command->add_option("--samples", options->verify.samples, "Number of samples.")
      ->check(wholeNumber<std::uint64_t>(1))
      ->capture_default_str();
  command->add_option("--seed", options->verify.seed, "Seed of the random samples.")
      ->check(wholeNumber<std::uint64_t>())
      ->capture_default_str();
  command
      ->add_option("--tolerance", options->verify.tolerance,
                   "Greatest error of the input, as a share of its range.")
      ->check(numberAbove(0.0))
      ->capture_default_str();
  addThreads(*command, options->verify.threads);
  command->add_option("--json", options->json, "Write the report to this file as JSON.");
  command->add_flag("--quiet", options->quiet, "Print nothing. The exit code is the answer.");
  addExact(command, options);
  command->callback([options, &exit_code] {
    if (!options->certificate.empty() && !options->exact && options->reduced_from.empty())
      throw CLI::ValidationError("--certificate requires --exact or --reduced-from");
    exit_code = !options->reduced_from.empty() ? verifyReducedMap(*options)
                : options->exact               ? verifyExact(*options)
                                               : verifyMap(*options);
  });
}

}  // namespace polyfly
