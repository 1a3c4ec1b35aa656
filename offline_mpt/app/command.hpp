#pragma once

#include <atomic>
#include <cstdint>
#include <initializer_list>
#include <string>

#include "command_line/command_line.hpp"
#include "offline_mpt/partition.hpp"

namespace polyfly {

/// What the program returns to the shell.
enum class ExitCode {
  kDone = 0,
  kFailed = 1,    ///< the map is wrong, or has a gap
  kBadInput = 2,  ///< a file, an option or the problem breaks a rule; nothing was written
  kStopped = 3,   ///< interrupted, or a limit was reached; what is said to be kept is kept
};

/// Each adds one subcommand; its callback sets `exit_code`.
void addSolve(CLI::App& app, ExitCode& exit_code);
void addInfo(CLI::App& app, ExitCode& exit_code);
void addEval(CLI::App& app, ExitCode& exit_code);
void addVerify(CLI::App& app, ExitCode& exit_code);
void addReduce(CLI::App& app, ExitCode& exit_code);
void addPlot(CLI::App& app, ExitCode& exit_code);
void addAnalyze(CLI::App& app, ExitCode& exit_code);
void addSet(CLI::App& app, ExitCode& exit_code);
void addBounds(CLI::App& app, ExitCode& exit_code);
void addCount(CLI::App& app, ExitCode& exit_code);

/// What an exploration that ended so returns to the shell.
ExitCode exitCode(ExploreStatus status);

/// The options --threads, --time-limit and --memory-limit of an exploration.
void addExploreLimits(CLI::App& command, int& threads, double& time_limit, std::uint64_t& memory_limit);

/// A flag that SIGINT and SIGTERM set from now on. The second signal ends the program at once.
const std::atomic<bool>& stopOnSignal();

/// Signals end the program at once again: for work that cannot be stopped half-way.
void endOnSignal();

/// Signals do nothing from now on: for a process that another one tells when to end.
void ignoreSignals();

/// Number of processors, at least 1; under an MPI launcher this process's share of them.
int defaultThreads();

/// Writes a text as writeFileAtomically does. Throws Error.
void writeText(const std::string& path, const std::string& text);

/// Throws Error when `path` cannot be made: its folder does not exist, or it is a folder itself; or when it
/// is one of the files that the command reads or writes `beside` it (empty names apart), which would be lost.
/// Called before long work.
void checkWritable(const std::string& path, std::initializer_list<std::string> beside = {});

}  // namespace polyfly
