#include <cstdio>
#include <memory>

#include "command.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/program_json.hpp"
#include "mpc_core/read_problem.hpp"

namespace polyfly {
namespace {

const char kCondenseFooter[] =
    R"(The result is the parametric program of a tracking problem in the generic form, with names, units, period, names of
rows and slacks. 'solve' takes it like the problem itself, and finds the same regions.
region_maps/problems/README.md (Generic programs) explains the keys.

Example:
  offline_mpt condense multirotor_lateral.yaml -o lateral.json)";

struct CondenseArguments {
  std::string problem;
  std::string output;
  bool quiet = false;
};

ExitCode writeCondensed(const CondenseArguments& options) {
  checkOutputs({{options.output}}, filesOfProblem(options.problem));
  const ParametricProgram program = loadProgram(options.problem);
  writeText(options.output, programJson(program));
  if (!options.quiet)
    std::printf("%s: %d variables, %d rows, %d parameters, %d inputs\n", options.output.c_str(),
                program.variableCount(), program.rowCount(), program.parameterCount(), program.inputCount());
  return ExitCode::kDone;
}

}  // namespace

void addCondense(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<CondenseArguments>();
  CLI::App* command = app.add_subcommand("condense", "Write the parametric program of a problem as JSON.");
  command->footer(kCondenseFooter);
  command->add_option("PROBLEM", options->problem, "Problem file, .yaml or .json.")->required();
  command->add_option("-o,--output", options->output, "JSON file to write.")->required();
  command->add_flag("--quiet", options->quiet, "Print nothing but errors.");
  command->callback([options, &exit_code] { exit_code = writeCondensed(*options); });
}

}  // namespace polyfly
