#include <algorithm>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "command.hpp"
#include "polytope_sets/invariant_set.hpp"
#include "signals.hpp"

namespace polyfly {
namespace {

const char kInvariantFooter[] =
    R"(offline_mpt/sets/README.md describes model files. Without --float, all computations are exact, in
fractions. The output shows rounded numbers. -o writes the set exactly, as a set file.

Exit codes:
  0  The set is the maximal one.
  1  The set is empty.
  2  The input is invalid.
  3  A limit was reached.

Example:
  offline_mpt set invariant model.yaml -o safe.json)";

struct InvariantArguments {
  std::string model;
  std::string output;
  bool json = false;
  bool floating = false;
  InvariantOptions options;
};

const char* name(InvariantSet::Status status) {
  switch (status) {
    case InvariantSet::Status::kMaximal:
      return "maximal";
    case InvariantSet::Status::kEmpty:
      return "empty";
    case InvariantSet::Status::kLimit:
      return "limit";
  }
  return "unknown";
}

void printJson(const InvariantSet& result, const InvariantOptions& options, bool proven) {
  nlohmann::ordered_json json = {{"status", name(result.status)}, {"iterations", result.iterations}};
  json["arithmetic"] = options.exact ? "exact" : "float";
  json["tolerance"] = options.exact ? 0.0 : options.tolerance;
  json["proven_invariant"] = proven;
  json["dimension"] = result.set.dimension;
  json["half_spaces"] = result.set.rows.size();
  json["equalities"] = result.set.equalities.size();
  json["set"] = nlohmann::ordered_json::parse(setText(result.set));
  std::printf("%s\n", json.dump(2).c_str());
}

/// Rows scaled so that the greatest entry is 1.
void printRows(const std::vector<ExactHalfSpace>& rows, const char* relation) {
  for (const ExactHalfSpace& row : rows) {
    Rational greatest;
    for (const Rational& value : row.a) greatest = std::max(greatest, Rational(abs(value)));
    if (greatest == 0) greatest = 1;
    for (const Rational& value : row.a) std::printf("  %.10g", nearestDouble(Rational(value / greatest)));
    std::printf("  %s  %.10g\n", relation, nearestDouble(Rational(row.b / greatest)));
  }
}

void printText(const InvariantSet& result, const InvariantOptions& options, bool proven) {
  std::printf("%s after %d iterations, %s", name(result.status), result.iterations,
              options.exact ? "exact" : "floating point");
  if (!options.exact) std::printf(" with tolerance %.3g", options.tolerance);
  std::printf("; invariance %s\n", proven ? "proven" : "not proven");
  std::printf("%zu half-spaces, %zu equalities in %d dimensions\n", result.set.rows.size(),
              result.set.equalities.size(), result.set.dimension);
  printRows(result.set.rows, "<=");
  printRows(result.set.equalities, "= ");
}

ExitCode computeInvariant(InvariantArguments arguments) {
  checkOutputs({{arguments.output}}, {arguments.model});
  InvariantOptions& options = arguments.options;
  options.exact = !arguments.floating;
  endOnSignal(arguments.model + ": interrupted: nothing was computed");
  const SetModel model = loadModel(arguments.model);
  const InvariantSet result = maximalInvariantSet(model, options);
  const bool is_known = result.status == InvariantSet::Status::kMaximal;
  const bool proven = is_known && proveInvariant(model, result.set).holds;
  ignoreSignals();
  if (!arguments.output.empty()) writeText(arguments.output, setText(result.set));
  if (arguments.json) {
    printJson(result, options, proven);
  } else {
    printText(result, options, proven);
  }
  if (result.status == InvariantSet::Status::kEmpty) return ExitCode::kFailed;
  return is_known ? ExitCode::kDone : ExitCode::kStopped;
}

}  // namespace

void addSet(CLI::App& app, ExitCode& exit_code) {
  auto arguments = std::make_shared<InvariantArguments>();
  CLI::App* const set = app.add_subcommand("set", "Compute invariant sets.");
  set->require_subcommand(1);
  CLI::App* const command = set->add_subcommand(
      "invariant",
      "Compute the maximal (robust) control invariant set of a model; without inputs, the positively "
      "invariant one.");
  command->footer(kInvariantFooter);
  command->add_option("MODEL", arguments->model, "Model file.")->required();
  command->add_option("-o,--output", arguments->output, "Write the set to this file, exactly.");
  command->add_flag("--json", arguments->json, "Print JSON with exact numbers.");
  CLI::Option* const floating =
      command->add_flag("--float", arguments->floating, "Compute in floating point.");
  command
      ->add_option("--tolerance", arguments->options.tolerance,
                   "With --float: smaller distances count as zero.")
      ->check(numberAbove(0.0))
      ->needs(floating)
      ->capture_default_str();
  command
      ->add_option("--max-iterations", arguments->options.max_iterations,
                   "Limit of the steps of the recursion.")
      ->check(wholeNumber(1, 1000000))
      ->capture_default_str();
  command->callback([arguments, &exit_code] { exit_code = computeInvariant(*arguments); });
}

}  // namespace polyfly
