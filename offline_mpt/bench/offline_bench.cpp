// Measures one thing about the offline toolchain and prints one JSON object. test/bench/offline.py runs it,
// each time in a process of its own so that memory and caches start clean, and puts the answers into a table.
#include <cstdio>
#include <functional>

#include "bench_commands.hpp"
#include "command_line/command_line.hpp"

namespace {

using polyfly::numberAbove;
using polyfly::wholeNumber;
using polyfly::bench::Json;

constexpr int kMaxThreads = 256;

int run(int argc, char** argv) {
  CLI::App app("Measures one thing about the offline toolchain; prints one JSON object.", "bench_offline");
  app.require_subcommand(1);
  std::function<Json()> measure;

  polyfly::bench::SolveArguments solve;
  CLI::App* command = app.add_subcommand("solve", "explore a program: CPU time, regions, samples, memory");
  command->add_option("PROBLEM", solve.problem, "problem file")->required();
  command->add_option("--runs", solve.runs, "runs of short problems")->check(wholeNumber(1, 1000));
  command->add_option("--threads", solve.threads, "worker threads")->check(wholeNumber(1, kMaxThreads));
  command->add_option("--time-limit", solve.time_limit, "of one run [s]")->check(numberAbove(0.0));
  command->callback([&] { measure = [&] { return polyfly::bench::solveProblem(solve); }; });

  polyfly::bench::LookupArguments lookup;
  command = app.add_subcommand("lookup", "build a map with its tree and time look-ups");
  command->add_option("PROBLEM", lookup.problem, "problem file")->required();
  command->add_option("--seed", lookup.seed, "of the parameters")->check(wholeNumber<std::uint64_t>());
  command->add_option("--samples", lookup.samples, "parameters")->check(wholeNumber(64, 100000000));
  command->callback([&] { measure = [&] { return polyfly::bench::timeLookups(lookup); }; });

  polyfly::bench::TreeArguments tree;
  command =
      app.add_subcommand("tree", "a small search tree beside one whose leaves hold one law and test nothing");
  command->add_option("PROBLEM", tree.problem, "problem file")->required();
  command->add_option("--time-limit", tree.time_limit, "of the other tree [s]")->check(numberAbove(0.0));
  command->callback([&] { measure = [&] { return polyfly::bench::compareTrees(tree); }; });

  polyfly::bench::CertifyArguments certify;
  command = app.add_subcommand("certify", "time the exact verification of a map");
  command->add_option("PROBLEM", certify.problem, "problem file")->required();
  command->add_option("--threads", certify.threads, "worker threads")->check(wholeNumber(1, kMaxThreads));
  command->add_option("--time-limit", certify.time_limit, "[s]")->check(numberAbove(0.0));
  command->callback([&] { measure = [&] { return polyfly::bench::timeCertificate(certify); }; });

  command = app.add_subcommand("calibrate", "time a fixed piece of arithmetic, to compare machines");
  command->callback([&] { measure = polyfly::bench::calibrate; });

  return polyfly::runTool(app, argc, argv, [&] {
    std::printf("%s\n", measure().dump().c_str());
    return 0;
  });
}

}  // namespace

int main(int argc, char** argv) { return run(argc, argv); }
