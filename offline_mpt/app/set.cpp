#include <cstdio>
#include <memory>

#include "command.hpp"
#include "polyfly_base/error.hpp"
#include "polytope_sets/polytope.hpp"
#include "set_output.hpp"
#include "signals.hpp"

namespace polyfly {
namespace {

const char kFooter[] =
    "Set files, YAML or JSON: polyfly_set: 1, and A and b (A x <= b), A_eq and b_eq, box, or vertices; "
    "numbers\n"
    "count as they are written (0.1 is one tenth; \"1/3\" is allowed). Model files: "
    "offline_mpt/sets/README.md.\n"
    "All is computed in fractions, without rounding, but for what --float says. Output: rounded numbers; "
    "with\n"
    "--json exact ones beside them; -o writes the resulting set, exact, as a set file.\n"
    "\n"
    "Exit codes: 0 done, or the answer is yes; 1 the answer is no; 2 bad input; 3 a limit was reached.\n"
    "\n"
    "Examples:\n"
    "  offline_mpt set info box.yaml\n"
    "  offline_mpt set project set.yaml --keep 1,2 -o shadow.json\n"
    "  offline_mpt set minkowski a.yaml b.yaml --json\n"
    "  offline_mpt set invariant model.yaml -o safe.json\n"
    "  offline_mpt set check model.yaml safe.json";

struct Options {
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

ExitCode yesOrNo(bool answer, const Options& options) {
  options.output.printAnswer(answer);
  return answer ? ExitCode::kDone : ExitCode::kFailed;
}

ExitCode showVolume(const Options& options) {
  const ExactPolytope set = loadSet(options.first);
  if (options.floating) {
    options.output.printVolume(volume(rounded(set), options.tolerance));
  } else {
    options.output.printVolume(volume(set));
  }
  return ExitCode::kDone;
}

ExitCode showProjection(const Options& options) {
  const ExactPolytope set = loadSet(options.first);
  std::vector<int> keep;
  for (const int j : options.keep) keep.push_back(j - 1);
  options.output.printSet(project(
      set, keep, options.elimination ? ProjectionMethod::kElimination : ProjectionMethod::kGenerators));
  return ExitCode::kDone;
}

ExitCode showInvariant(const Options& options) {
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

ExitCode showCheck(const Options& options) {
  const SetModel model = loadModel(options.first);
  const InvarianceProof proof = proveInvariant(model, loadSet(options.second));
  options.output.printProof(proof);
  return proof.holds ? ExitCode::kDone : ExitCode::kFailed;
}

using Action = std::function<ExitCode(const Options&)>;

/// Adds `set NAME` with one or two files.
CLI::App* addAction(CLI::App* command, const std::shared_ptr<Options>& options, ExitCode& exit_code,
                    const char* name, const char* text, int files, const Action& action) {
  CLI::App* sub = command->add_subcommand(name, text);
  sub->add_option(files == 1 ? "FILE" : "FIRST", options->first, "set or model file")->required();
  if (files == 2) sub->add_option("SECOND", options->second, "set file")->required();
  sub->add_flag("--json", options->output.json, "as JSON, with exact numbers");
  sub->callback([options, action, &exit_code] {
    checkOutputs({{options->output.file}}, {options->first, options->second});
    exit_code = action(*options);
  });
  return sub;
}

void addOutput(CLI::App* sub, const std::shared_ptr<Options>& options) {
  sub->add_option("-o,--output", options->output.file, "write the resulting set, exact, to this file");
}

void addFloat(CLI::App* sub, const std::shared_ptr<Options>& options) {
  CLI::Option* floating = sub->add_flag("--float", options->floating, "in floating point");
  sub->add_option("--tolerance", options->tolerance, "with --float: distances below it count as none")
      ->check(numberAbove(0.0))
      ->needs(floating)
      ->capture_default_str();
}

void addQuestions(CLI::App* command, const std::shared_ptr<Options>& options, ExitCode& exit_code) {
  addAction(command, options, exit_code, "equal", "Whether two sets hold the same points", 2,
            [](const Options& o) { return yesOrNo(equal(loadSet(o.first), loadSet(o.second)), o); });
  addAction(command, options, exit_code, "subset", "Whether FIRST lies in SECOND", 2,
            [](const Options& o) { return yesOrNo(contains(loadSet(o.second), loadSet(o.first)), o); });
  addAction(command, options, exit_code, "contains", "Whether a point lies in a set", 1,
            [](const Options& o) { return yesOrNo(contains(loadSet(o.first), parseNumbers(o.point)), o); })
      ->add_option("--point", options->point, "numbers, separated by commas")
      ->required();
  addAction(command, options, exit_code, "support", "Greatest value of a direction over a set", 1,
            [](const Options& o) {
              o.output.printSupport(support(loadSet(o.first), parseNumbers(o.point)));
              return ExitCode::kDone;
            })
      ->add_option("--direction", options->point, "numbers, separated by commas")
      ->required();
}

void addOperations(CLI::App* command, const std::shared_ptr<Options>& options, ExitCode& exit_code) {
  const auto add = [&](const char* name, const char* text, int files,
                       const std::function<ExactPolytope(const Options&)>& operation) {
    CLI::App* sub = addAction(command, options, exit_code, name, text, files, [operation](const Options& o) {
      o.output.printSet(operation(o));
      return ExitCode::kDone;
    });
    addOutput(sub, options);
    return sub;
  };
  add("minimal", "Remove redundant rows", 1, [](const Options& o) { return minimal(loadSet(o.first)); });
  add("intersect", "Points of both sets", 2,
      [](const Options& o) { return minimal(intersect(loadSet(o.first), loadSet(o.second))); });
  add("minkowski", "Sums of points of both sets", 2,
      [](const Options& o) { return minkowskiSum(loadSet(o.first), loadSet(o.second)); });
  add("pontryagin", "Points that SECOND may be added to within FIRST", 2,
      [](const Options& o) { return pontryaginDifference(loadSet(o.first), loadSet(o.second)); });
  add("image", "Points M x of a set's points x", 1,
      [](const Options& o) { return affineImage(loadSet(o.first), parseMatrix(o.matrix)); })
      ->add_option("--matrix", options->matrix, "rows separated by semicolons: \"1,1;0,1\"")
      ->required();
  add("preimage", "Points x with M x in a set", 1,
      [](const Options& o) { return minimal(preimage(loadSet(o.first), parseMatrix(o.matrix))); })
      ->add_option("--matrix", options->matrix, "rows separated by semicolons: \"1,1;0,1\"")
      ->required();
}

}  // namespace

void addSet(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand("set", "Compute with polytopes and invariant sets");
  command->footer(kFooter);
  command->require_subcommand(1);
  addAction(command, options, exit_code, "info", "Size, bounding box, inscribed ball and volume", 1,
            [](const Options& o) {
              o.output.printInfo(loadSet(o.first));
              return ExitCode::kDone;
            });
  addAction(command, options, exit_code, "vertices", "Vertices (and rays, where unbounded)", 1,
            [](const Options& o) {
              o.output.printGenerators(generators(loadSet(o.first)));
              return ExitCode::kDone;
            });
  CLI::App* sub = addAction(command, options, exit_code, "volume", "Volume", 1, showVolume);
  addFloat(sub, options);
  sub = addAction(command, options, exit_code, "project", "Drop coordinates", 1, showProjection);
  sub->add_option("--keep", options->keep, "coordinates to keep, from 1, separated by commas")
      ->check(wholeNumber<int>(1))
      ->required()
      ->delimiter(',');
  sub->add_flag("--elimination", options->elimination, "by Fourier-Motzkin elimination instead of vertices");
  addOutput(sub, options);
  addQuestions(command, options, exit_code);
  addOperations(command, options, exit_code);
  sub = addAction(command, options, exit_code, "invariant",
                  "Maximal (robust) control invariant set of a model; without inputs, positively invariant",
                  1, showInvariant);
  addFloat(sub, options);
  addOutput(sub, options);
  sub->add_option("--max-iterations", options->max_iterations, "steps of the recursion")
      ->check(wholeNumber(1, 1000000))
      ->capture_default_str();
  addAction(command, options, exit_code, "check",
            "Prove that a set (SECOND) is invariant for a model (FIRST)", 2, showCheck);
}

}  // namespace polyfly
