#include "polytope_sets/terminal_set.hpp"

#include <cstdio>
#include <memory>

#include "command.hpp"
#include "mpc_core/read_problem.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/read_text.hpp"
#include "signals.hpp"

namespace polyfly {
namespace {

const char kTerminalSetFooter[] =
    R"(The set holds all errors from which the Riccati gain meets all hard bounds for ever, for every reference in the ranges
of the parameters. It is proven invariant in fractions. The result is the problem with the key terminal_set.
region_maps/problems/README.md explains it.

Example:
  offline_mpt terminal_set multirotor_vertical.yaml -o vertical_stable.yaml)";

struct TerminalSetArguments {
  std::string problem;
  std::string output;
  bool quiet = false;
};

std::string numbersText(const Eigen::VectorXd& numbers) {
  std::string text = "[";
  char number[32];
  for (Eigen::Index i = 0; i < numbers.size(); ++i) {
    std::snprintf(number, sizeof number, "%s%.17g", i > 0 ? ", " : "", numbers(i));
    text += number;
  }
  return text + "]";
}

std::string keyText(const TerminalSet& set) {
  std::string text =
      "\n# Largest invariant set of the Riccati gain within the hard bounds.\nterminal_set:\n  T:\n";
  for (Eigen::Index i = 0; i < set.T.rows(); ++i) text += "    - " + numbersText(set.T.row(i)) + "\n";
  return text + "  t: " + numbersText(set.t) + "\n";
}

ExitCode addTerminalSetTo(const TerminalSetArguments& options) {
  if (!endsWith(options.problem, ".yaml") && !endsWith(options.problem, ".yml"))
    throw Error(options.problem + ": file: must be a tracking problem (.yaml, .yml)");
  checkOutputs({{options.output}}, filesOfProblem(options.problem));
  const std::string text = readProblem(options.problem);
  const MpcProblem problem = parseProblem(text, options.problem);
  if (problem.T.rows() > 0) throw Error(options.problem + ": terminal_set: is given already");
  endOnSignal(options.problem + ": interrupted: nothing was written");
  const TerminalSet set = terminalSet(problem);
  ignoreSignals();
  const std::string result = text + (text.back() == '\n' ? "" : "\n") + keyText(set);
  parseProblem(result, options.output);
  writeText(options.output, result);
  if (!options.quiet)
    std::printf("%s: terminal set of %d half-spaces after %d steps, proven invariant\n",
                options.output.c_str(), static_cast<int>(set.T.rows()), set.iterations);
  return ExitCode::kDone;
}

}  // namespace

void addTerminalSet(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<TerminalSetArguments>();
  CLI::App* command =
      app.add_subcommand("terminal_set", "Add the largest invariant terminal set to a tracking problem.");
  command->footer(kTerminalSetFooter);
  command->add_option("PROBLEM", options->problem, "Problem file, .yaml.")->required();
  command->add_option("-o,--output", options->output, "Problem file to write.")->required();
  command->add_flag("--quiet", options->quiet, "Print nothing but errors.");
  command->callback([options, &exit_code] { exit_code = addTerminalSetTo(*options); });
}

}  // namespace polyfly
