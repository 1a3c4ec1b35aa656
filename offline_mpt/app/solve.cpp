#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <optional>

#include "command.hpp"
#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/read_problem.hpp"
#include "mpi_session.hpp"
#include "offline_mpt/encode.hpp"
#include "offline_mpt/explore.hpp"
#include "offline_mpt/process_group.hpp"
#include "offline_mpt/soft_bounds.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/provenance.hpp"
#include "polyfly_base/read_text.hpp"
#include "problem_types.hpp"
#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/write_map.hpp"
#include "safety_filter/safe_set.hpp"
#include "signals.hpp"
#include "solve_report.hpp"
#include "support/vector_text.hpp"
#include "verify/self_check.hpp"

namespace polyfly {
namespace {

const char kSolveFooter[] =
    R"(The problem is a tracking problem of one axis, a minimum-peak robust MPC or a safety filter (.yaml, .yml), or
a parametric program in the generic form (.json). A robust MPC has no limit but --time-limit, and a
stopped run of it leaves the checkpoint only. Of a safety filter, the safe set is computed and proven
first; the map carries it. The same problem gives the same bytes for any number of threads.

Ctrl-C, SIGTERM, SIGHUP or a limit stops the run. It then writes MAP.checkpoint. --resume continues from
there to the same bytes as an uninterrupted run. The checkpoint is also written every --checkpoint-period,
and before the search tree is built. The complete map removes it.

A stopped run also writes the regions found so far, if their search tree takes less than a second. The
status of the map says so. It replaces an existing MAP only with --force. A new run replaces the
checkpoint of an unfinished run only with --force.

The search tree answers which region holds a parameter. --tree fast builds it in about the time of the
exploration. --tree small makes the shortest worst case, and the largest file where parameters are many.

With mpirun, the processes explore together (--threads each). Process 0 builds the search tree and writes the
same map. If a process is lost, the run ends with a checkpoint.

Examples:
  offline_mpt solve multirotor_lateral.yaml -o lateral.map --stats lateral_stats.json
  offline_mpt solve big.json -o big.map --threads 8 --time-limit 600 --memory-limit 4G
  offline_mpt solve big.json -o big.map --resume
  mpirun -n 4 offline_mpt solve big.json -o big.map --threads 2)";

// How long the search tree of a stopped exploration may take [s].
constexpr double kTreeOfAPart = 1.0;

bool exists(const std::string& path) {
  struct stat status = {};
  return ::stat(path.c_str(), &status) == 0;
}

Partition exploreWithProgress(const ParametricProgram& program, const SolveArguments& options,
                              ProcessGroup* group) {
  ExploreOptions explore_options = options.explore;
  explore_options.stop = &stopOnSignal(options.time_limit);
  explore_options.checkpoint = checkpointOf(options);
  explore_options.group = group;
  Progress progress(options.quiet);
  std::optional<std::uint64_t> before;  // regions of a checkpoint
  explore_options.progress = [&](const ExploreProgress& state) {
    if (!before) before = state.regions;
    const double rate = static_cast<double>(state.regions - *before) / progress.elapsed();
    std::string text = std::to_string(state.regions) + " regions, " + std::to_string(state.open) + " open, " +
                       std::to_string(std::llround(rate)) + " regions/s";
    if (state.unsaved) text += ", CHECKPOINT NOT WRITTEN";
    progress.show(text);
  };
  Partition partition = explore(program, explore_options);
  if (partition.status == ExploreStatus::kInterrupted && timeIsUp())
    partition.status = ExploreStatus::kLimited;
  return partition;
}

// True when the result may be written; says why not otherwise.
bool mayWrite(const SolveArguments& options, const Partition& partition) {
  if (partition.status == ExploreStatus::kComplete || options.force) return true;
  if (partition.regions.empty()) {
    std::fprintf(stderr, "offline_mpt: %s: %s before the first region, nothing was kept\n",
                 options.map.c_str(), toString(partition.status));
    return false;
  }
  if (exists(options.map)) {
    std::fprintf(stderr,
                 "offline_mpt: %s: %s after %zu regions; not written, the existing file stands (--force)\n",
                 options.map.c_str(), toString(partition.status), partition.regions.size());
    return false;
  }
  return true;
}

// From here on a signal or the end of the time limit ends the program. Nothing of an unfinished search tree
// can be kept, and the checkpoint holds the regions. An exploration that was stopped gets a tree if that is
// quick.
void limitTree(const SolveArguments& options, const Partition& partition) {
  const std::string unwritten = options.map + ": not written: stopped while its search tree was built";
  const std::string regions = std::to_string(partition.regions.size()) + " regions";
  if (isStopped(partition)) {  // reportStop has said where they are
    endOnSignal(unwritten, stopRequested() ? kTreeOfAPart : 0.0);
    return;
  }
  if (partition.stats.unsaved) {
    std::fprintf(stderr, "offline_mpt: %s: could not be written; only the map will hold %s\n",
                 checkpointOf(options).c_str(), regions.c_str());
  }
  const std::string message = unwritten + "; " + whatRemains(options, partition);
  endOnSignal(message);
}

void checkFiles(const SolveArguments& options) {
  const std::string checkpoint = checkpointOf(options);
  checkOutputs({{options.map, Output::Kind::kFile}, {options.stats}, {checkpoint, Output::Kind::kFile}},
               filesOfProblem(options.problem));
  const bool unfinished = exists(checkpoint);
  if (options.explore.resume && !unfinished) throw Error(checkpoint + ": there is no checkpoint to resume");
  if (!options.explore.resume && unfinished && !options.force) {
    throw Error(checkpoint + ": an unfinished run left this: continue with --resume, or --force a new one");
  }
}

// That of an exploration which reached its end has served once its result is written or refused.
void removeCheckpoint(const SolveArguments& options, const Partition& partition) {
  if (!isStopped(partition)) ::unlink(checkpointOf(options).c_str());
}

MapContent encodeWithProgress(const ParametricProgram& program, const Partition& partition,
                              const SolveArguments& options) {
  Progress progress(options.quiet);
  TreeOptions tree;
  tree.threads = options.explore.threads;
  // Of a part the regions count, and they have a second.
  tree.mode = isStopped(partition) ? TreeMode::kFast : options.tree_mode;
  tree.node_limit = options.tree_nodes;
  tree.progress = [&](std::uint64_t done, std::uint64_t total) {
    progress.show("search tree of " + std::to_string(partition.regions.size()) + " regions, " +
                  std::to_string(100 * done / std::max<std::uint64_t>(total, 1)) + " %");
  };
  MapContent content = encode(program, partition, tree);
  progress.finish();
  return content;
}

// The program with hard bounds may have so many times the regions of the soft one.
constexpr std::uint64_t kHardRegionFactor = 4;

// By how much soft bounds are exceeded, and whether their l1 weights are exact: said, and kept in the map's notes.
void addSoftBounds(const ParametricProgram& program, const Partition& partition,
                   const SolveArguments& options, MapContent* content) {
  if (program.slacks.empty() || partition.status != ExploreStatus::kComplete) return;
  ExploreOptions explore_options = options.explore;
  explore_options.region_limit = kHardRegionFactor * partition.regions.size() + kHardRegionFactor;
  const auto note = [&](const std::string& text) {
    content->solver_notes += text + "\n";
    if (!options.quiet) std::printf("%s: %s\n", options.map.c_str(), text.c_str());
  };
  for (const SoftBound& bound : softBounds(program, partition, explore_options)) note(softBoundText(bound));
}

// False where the map is wrong; says why.
bool answersRight(const SolveArguments& options, const ParametricProgram& program,
                  const MapContent& content) {
  const AnswerCheck check = checkAnswers(content, program, {options.explore.threads, nullptr, {}});
  if (check.fault.empty()) return true;
  std::fprintf(stderr, "offline_mpt: %s: not written: %s\n", options.map.c_str(), check.fault.c_str());
  return false;
}

JobInput readInput(const SolveArguments& options) {
  JobInput input;
  input.own = ownSolverOf(options.problem);
  if (input.own == nullptr) {
    endOnSignal(options.problem + ": interrupted: nothing was written", options.time_limit);
    input.program = loadCompleteProgram(options.problem);
  }
  input.summary = "problem of " + input.kind() + ", " +
                  checksumOf(input.own == nullptr ? input.program.text : readText(options.problem));
  return input;
}

ExitCode lead(const SolveArguments& options, MpiSession& session) {
  checkFiles(options);
  PhaseClock clock;
  const JobInput input = session.readAlike([&] { return readInput(options); });
  if (const OwnSolver* own = input.own; own != nullptr) {
    session.leave();
    if (options.explore.region_limit != ExploreOptions().region_limit || options.explore.memory_limit > 0)
      throw Error(options.problem + ": type: " + own->type +
                  " takes no --region-limit and no --memory-limit");
    return own->solve(options);
  }
  const ParametricProgram& program = input.program;
  if (!options.quiet) printRemarks(options.problem, program);
  clock.end("load");
  const Partition partition = inFile(options.problem, program,
                                     [&] { return exploreWithProgress(program, options, session.group()); });
  clock.end("explore");
  reportStop(options, partition);
  reportUnbounded(options, partition);
  if (partition.stats.lost_process > 0) {
    session.abort();
    return ExitCode::kStopped;
  }
  clock.leave(session);
  if (partition.status == ExploreStatus::kInfeasible) {
    throw Error(options.problem + ": infeasible: no parameter in its box admits a solution");
  }
  if (partition.status == ExploreStatus::kUnbounded && partition.regions.empty()) {
    throw Error(options.problem + ": the cost is unbounded below at theta = " +
                vectorText(partition.unbounded_at) + ", and no set of parameters has a finite optimum");
  }
  if (!mayWrite(options, partition)) {
    removeCheckpoint(options, partition);
    return exitCode(partition.status);
  }
  limitTree(options, partition);
  MapContent content =
      inFile(options.problem, program, [&] { return encodeWithProgress(program, partition, options); });
  clock.end("encode");
  addSoftBounds(program, partition, options, &content);
  clock.end("encode");
  const bool is_right = answersRight(options, program, content);
  clock.end("check");
  ignoreSignals();
  if (!is_right) {
    removeCheckpoint(options, partition);
    return ExitCode::kFailed;
  }
  writeMap(content, options.map);
  const RegionMap map = RegionMap::open(options.map);
  clock.end("write");
  removeCheckpoint(options, partition);
  if (!options.stats.empty()) {
    writeText(options.stats,
              solveStats(program, partition, map, clock, options.explore.threads, session.processes()));
  }
  reportEnd(options, partition, map, clock);
  return exitCode(partition.status);
}

// A process of an MPI launcher that is not the first. It says nothing, and process 0 tells it when to end: a
// signal to all of them must leave process 0 the time to save.
void assist(const SolveArguments& options, MpiSession& session) {
  PhaseClock clock;
  ignoreSignals();
  const JobInput input = session.readAlike([&] { return readInput(options); });
  if (input.own != nullptr) return;  // process 0 solves it alone
  clock.end("load");
  runWorkerProcess(input.program, options.explore, *session.group());
  clock.end("explore");
  clock.leave(session);
}

ExitCode solve(const SolveArguments& options) {
  MpiSession session;
  if (!session.leads()) return session.assist([&] { assist(options, session); });
  try {
    return lead(options, session);
  } catch (const LostProcess& lost) {
    std::fprintf(stderr, "offline_mpt: %s: process %d of the MPI job was lost\n", options.problem.c_str(),
                 lost.rank());
    session.abort();
    return ExitCode::kStopped;
  }
}

void addTreeOptions(CLI::App& command, TreeMode& mode, std::uint64_t& nodes) {
  const std::map<std::string, TreeMode> modes = {
      {"fast", TreeMode::kFast}, {"auto", TreeMode::kAuto}, {"small", TreeMode::kSmall}};
  command
      .add_option_function<std::string>(
          "--tree", [&mode, modes](const std::string& name) { mode = modes.at(name); },
          "How far the search tree grows: fast, small (as far as it shortens look-ups), or auto (default).")
      ->check(CLI::IsMember(modes));
  command
      .add_option(
          "--tree-nodes", nodes,
          "Limit of interior nodes of the search tree (default: 2 per region; small: 64; at least 4096).")
      ->check(wholeNumber<std::uint64_t>(1));
}

}  // namespace

void addSolve(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<SolveArguments>();
  CLI::App* command =
      app.add_subcommand("solve", "Solve a problem for all parameters and write the region map.");
  command->footer(kSolveFooter);
  command->add_option("PROBLEM", options->problem, "Problem file, .yaml or .json.")->required();
  command->add_option("-o,--output", options->map, "Map file to write.")->required();
  command->add_option("--stats", options->stats, "Write counts and times to this file as JSON.");
  command->add_option("--region-limit", options->explore.region_limit, "Stop after this many regions.")
      ->check(wholeNumber<std::uint64_t>(1));
  addThreads(*command, options->explore.threads);
  addTimeLimit(*command, options->time_limit);
  command
      ->add_option("--memory-limit", options->explore.memory_limit,
                   "Stop when the exploration uses this many bytes; suffixes k, M, G (default: no limit).")
      ->transform(byteCount());
  command->add_flag("--resume", options->explore.resume, "Continue from MAP.checkpoint.");
  command
      ->add_option("--checkpoint-period", options->explore.checkpoint_period,
                   "Seconds between checkpoints (default: 300; 0: only at the end).")
      ->check(numberFrom(0.0));
  addTreeOptions(*command, options->tree_mode, options->tree_nodes);
  command->add_flag("--quiet", options->quiet, "Print nothing but errors.");
  command->add_flag("--force", options->force,
                    "Let a partial result replace an existing map, and a new run an old checkpoint.");
  command->callback([options, &exit_code] { exit_code = solve(*options); });
}

}  // namespace polyfly
