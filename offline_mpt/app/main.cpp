
#include "command.hpp"
#include "mpi_group.hpp"
#include "offline_mpt/reduce.hpp"
#include "polyfly_base/out_of_memory.hpp"

namespace {

void addRemovedCommands(CLI::App& app) {
  using polyfly::addRemoved;
  addRemoved(app, {"count"},
             "was removed; 'solve --region-limit N' ends with exit code 3 where there are more than N "
             "regions");
  addRemoved(app, {"bounds"},
             "was removed; 'disturbance_ranges' of the Python module computes them, 'calibrate disturbance' "
             "from bags");
  addRemoved(*app.get_subcommand("set"),
             {"check", "contains", "equal", "image", "info", "intersect", "minimal", "minkowski",
              "pontryagin", "preimage", "project", "subset", "support", "vertices", "volume"},
             "was removed; 'set invariant' stays, and polytope_sets/exact_polytope.hpp computes with "
             "polytopes in C++");
  addRemoved(*app.get_subcommand("reduce"), {"--merge"}, polyfly::kNoMerge);
  addRemoved(*app.get_subcommand("reduce"), {"--separate"}, polyfly::kNoSeparate);
}

const char kMainFooter[] =
    R"(Examples:
  offline_mpt solve multirotor_lateral.yaml -o lateral.map
  offline_mpt info lateral.map
  offline_mpt verify lateral.map --problem multirotor_lateral.yaml --samples 100000 --seed 1
  offline_mpt reduce lateral.map -o small.map
  offline_mpt diff lateral.map small.map
  offline_mpt plot lateral.map --slice e_p,e_v -o lateral.svg
  offline_mpt explore lateral.map -o lateral.html
  offline_mpt export lateral.map -o code --name lateral
  offline_mpt analyze lateral.map --model lateral_model.yaml
  offline_mpt set invariant model.yaml -o safe.json

Exit codes:
  0  The command succeeded.
  1  A verification or analysis failed, the partition has a gap, or the answer is no.
  2  A file, option or problem is invalid. Nothing was written.
  3  The command was interrupted or reached a limit. It prints what it kept.)";

}  // namespace

int main(int argc, char** argv) {
  polyfly::installOutOfMemoryHandler("offline_mpt");
  CLI::App app("Solves parametric programs, writes region maps, and analyses and verifies them.",
               "offline_mpt");
  app.footer(kMainFooter);
  app.require_subcommand(1);
  polyfly::ExitCode exit_code = polyfly::ExitCode::kDone;
  polyfly::addSolve(app, exit_code);
  polyfly::addCondense(app, exit_code);
  polyfly::addInfo(app, exit_code);
  polyfly::addEval(app, exit_code);
  polyfly::addVerify(app, exit_code);
  polyfly::addReduce(app, exit_code);
  polyfly::addDiff(app, exit_code);
  polyfly::addPlot(app, exit_code);
  polyfly::addExplore(app, exit_code);
  polyfly::addExport(app, exit_code);
  polyfly::addAnalyze(app, exit_code);
  polyfly::addSet(app, exit_code);
  polyfly::addTerminalSet(app, exit_code);
  addRemovedCommands(app);
  // Of the processes of a launcher, which all fail alike, one speaks.
  return polyfly::runTool(
      app, argc, argv, [&] { return static_cast<int>(exit_code); }, polyfly::launchedRank() == 0);
}
