#include <cstdio>
#include <memory>

#include "command.hpp"
#include "polyfly_base/error.hpp"
#include "polytope_sets/polytope.hpp"
#include "set_output.hpp"
#include "signals.hpp"

namespace polyfly {
namespace {

const char kSetFooter[] =
    R"(Set files are YAML or JSON. They have polyfly_set: 1 and A and b (A x <= b), A_eq and b_eq, box, or
vertices. Numbers are exact as written: 0.1 is one tenth, and "1/3" is allowed. offline_mpt/sets/README.md
describes model files. Without --float, all computations are exact, in fractions. The output shows rounded
numbers. --json adds the exact ones. -o writes the resulting set exactly, as a set file.

Exit codes:
  0  The command succeeded, or the answer is yes.
  1  The answer is no.
  2  The input is invalid.
  3  A limit was reached.

Examples:
  offline_mpt set info box.yaml
  offline_mpt set project set.yaml --keep 1,2 -o shadow.json
  offline_mpt set minkowski a.yaml b.yaml --json
  offline_mpt set invariant model.yaml -o safe.json
  offline_mpt set check model.yaml safe.json)";

struct SetArguments {
  std::string first;
  std::string second;
  std::vector<int> keep;
  bool elimination = false;
  std::string matrix;
  std::string point;
  bool floating = false;
  double tolerance = 1e-9;
  int max_iterations = 200;
  SetOutput output;
};

ExitCode yesOrNo(bool answer, const SetArguments& options) {
  options.output.printAnswer(answer);
  return answer ? ExitCode::kDone : ExitCode::kFailed;
}

ExitCode showVolume(const SetArguments& options) {
  const ExactPolytope set = loadSet(options.first);
  if (options.floating) {
    options.output.printVolume(volume(rounded(set), options.tolerance));
  } else {
    options.output.printVolume(volume(set));
  }
  return ExitCode::kDone;
}

ExitCode showProjection(const SetArguments& options) {
  const ExactPolytope set = loadSet(options.first);
  std::vector<int> keep;
  for (const int j : options.keep) keep.push_back(j - 1);
  options.output.printSet(project(
      set, keep, options.elimination ? ProjectionMethod::kElimination : ProjectionMethod::kGenerators));
  return ExitCode::kDone;
}

ExitCode showInvariant(const SetArguments& options) {
  InvariantOptions invariant;
  invariant.exact = !options.floating;
  invariant.tolerance = options.tolerance;
  invariant.max_iterations = options.max_iterations;
  invariant.stop = &stopOnSignal();
  const SetModel model = loadModel(options.first);
  const InvariantSet result = maximalInvariantSet(model, invariant);
  const bool known = result.status == InvariantSet::Status::kMaximal;
  options.output.printInvariant(result, invariant, known && proveInvariant(model, result.set).holds);
  if (result.status == InvariantSet::Status::kEmpty) return ExitCode::kFailed;
  return known ? ExitCode::kDone : ExitCode::kStopped;
}

ExitCode showCheck(const SetArguments& options) {
  const SetModel model = loadModel(options.first);
  const InvarianceProof proof = proveInvariant(model, loadSet(options.second));
  options.output.printProof(proof);
  return proof.holds ? ExitCode::kDone : ExitCode::kFailed;
}

using Action = std::function<ExitCode(const SetArguments&)>;

/// Adds `set NAME` with one or two files.
CLI::App* addAction(CLI::App* command, const std::shared_ptr<SetArguments>& options, ExitCode& exit_code,
                    const char* name, const char* text, int files, const Action& action) {
  CLI::App* sub = command->add_subcommand(name, text);
  sub->add_option(files == 1 ? "FILE" : "FIRST", options->first, "Set or model file.")->required();
  if (files == 2) sub->add_option("SECOND", options->second, "Set file.")->required();
  sub->add_flag("--json", options->output.json, "Print JSON with exact numbers.");
  sub->callback([options, action, &exit_code] {
    checkOutputs({{options->output.file}}, {options->first, options->second});
    exit_code = action(*options);
  });
  return sub;
}

void addOutput(CLI::App* sub, const std::shared_ptr<SetArguments>& options) {
  sub->add_option("-o,--output", options->output.file, "Write the resulting set to this file, exactly.");
}

void addFloat(CLI::App* sub, const std::shared_ptr<SetArguments>& options) {
  CLI::Option* floating = sub->add_flag("--float", options->floating, "Compute in floating point.");
  sub->add_option("--tolerance", options->tolerance, "With --float: smaller distances count as zero.")
      ->check(numberAbove(0.0))
      ->needs(floating)
      ->capture_default_str();
}

void addQuestions(CLI::App* command, const std::shared_ptr<SetArguments>& options, ExitCode& exit_code) {
  addAction(command, options, exit_code, "equal", "Tell whether two sets are equal.", 2,
            [](const SetArguments& o) { return yesOrNo(equal(loadSet(o.first), loadSet(o.second)), o); });
  addAction(command, options, exit_code, "subset", "Tell whether FIRST is a subset of SECOND.", 2,
            [](const SetArguments& o) { return yesOrNo(contains(loadSet(o.second), loadSet(o.first)), o); });
  addAction(
      command, options, exit_code, "contains", "Tell whether a point is in a set.", 1,
      [](const SetArguments& o) { return yesOrNo(contains(loadSet(o.first), parseNumbers(o.point)), o); })
      ->add_option("--point", options->point, "Numbers, separated by commas.")
      ->required();
  addAction(command, options, exit_code, "support", "Maximise a direction over a set.", 1,
            [](const SetArguments& o) {
              o.output.printSupport(support(loadSet(o.first), parseNumbers(o.point)));
              return ExitCode::kDone;
            })
      ->add_option("--direction", options->point, "Numbers, separated by commas.")
      ->required();
}

void addOperations(CLI::App* command, const std::shared_ptr<SetArguments>& options, ExitCode& exit_code) {
  const auto add = [&](const char* name, const char* text, int files,
                       const std::function<ExactPolytope(const SetArguments&)>& operation) {
    CLI::App* sub =
        addAction(command, options, exit_code, name, text, files, [operation](const SetArguments& o) {
          o.output.printSet(operation(o));
          return ExitCode::kDone;
        });
    addOutput(sub, options);
    return sub;
  };
  add("minimal", "Remove redundant rows.", 1,
      [](const SetArguments& o) { return minimal(loadSet(o.first)); });
  add("intersect", "Intersect two sets.", 2,
      [](const SetArguments& o) { return minimal(intersect(loadSet(o.first), loadSet(o.second))); });
  add("minkowski", "Compute the Minkowski sum of two sets.", 2,
      [](const SetArguments& o) { return minkowskiSum(loadSet(o.first), loadSet(o.second)); });
  add("pontryagin", "Compute the Pontryagin difference FIRST - SECOND.", 2,
      [](const SetArguments& o) { return pontryaginDifference(loadSet(o.first), loadSet(o.second)); });
  add("image", "Compute the image M x of a set.", 1,
      [](const SetArguments& o) { return affineImage(loadSet(o.first), parseMatrix(o.matrix)); })
      ->add_option("--matrix", options->matrix, "Rows separated by semicolons: \"1,1;0,1\".")
      ->required();
  add("preimage", "Compute the points x with M x in a set.", 1,
      [](const SetArguments& o) { return minimal(preimage(loadSet(o.first), parseMatrix(o.matrix))); })
      ->add_option("--matrix", options->matrix, "Rows separated by semicolons: \"1,1;0,1\".")
      ->required();
}

}  // namespace

void addSet(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<SetArguments>();
  CLI::App* command = app.add_subcommand("set", "Compute with polytopes and invariant sets.");
  command->footer(kSetFooter);
  command->require_subcommand(1);
  addAction(command, options, exit_code, "info", "Show size, bounding box, inscribed ball and volume.", 1,
            [](const SetArguments& o) {
              o.output.printInfo(loadSet(o.first));
              return ExitCode::kDone;
            });
  addAction(command, options, exit_code, "vertices", "List vertices (and rays of an unbounded set).", 1,
            [](const SetArguments& o) {
              o.output.printGenerators(generators(loadSet(o.first)));
              return ExitCode::kDone;
            });
  CLI::App* sub = addAction(command, options, exit_code, "volume", "Compute the volume.", 1, showVolume);
  addFloat(sub, options);
  sub = addAction(command, options, exit_code, "project", "Project a set on some coordinates.", 1,
                  showProjection);
  sub->add_option("--keep", options->keep, "Coordinates to keep, from 1, separated by commas.")
      ->check(wholeNumber<int>(1))
      ->required()
      ->delimiter(',');
  sub->add_flag("--elimination", options->elimination,
                "Use Fourier-Motzkin elimination instead of vertices.");
  addOutput(sub, options);
  addQuestions(command, options, exit_code);
  addOperations(command, options, exit_code);
  sub = addAction(command, options, exit_code, "invariant",
                  "Compute the maximal (robust) control invariant set of a model; without inputs, the "
                  "positively invariant one.",
                  1, showInvariant);
  addFloat(sub, options);
  addOutput(sub, options);
  sub->add_option("--max-iterations", options->max_iterations, "Limit of the steps of the recursion.")
      ->check(wholeNumber(1, 1000000))
      ->capture_default_str();
  addAction(command, options, exit_code, "check",
            "Prove that a set (SECOND) is invariant for a model (FIRST).", 2, showCheck);
}

}  // namespace polyfly
