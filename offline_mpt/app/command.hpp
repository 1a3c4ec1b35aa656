#pragma once

#include <cstdint>
#include <string>

#include "command_line/command_line.hpp"
#include "offline_mpt/partition.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/outputs.hpp"

namespace polyfly {

struct ParametricProgram;

/// What the program returns to the shell.
enum class ExitCode {
  kDone = 0,
  /// The map is wrong, or has a gap.
  kFailed = 1,
  /// A file, an option or the problem breaks a rule. Nothing was written.
  kBadInput = 2,
  /// The work was interrupted, or reached a limit. Files that the output names are kept.
  kStopped = 3,
};

/// Each adds one subcommand; its callback sets `exit_code`.
void addSolve(CLI::App& app, ExitCode& exit_code);
void addInfo(CLI::App& app, ExitCode& exit_code);
void addEval(CLI::App& app, ExitCode& exit_code);
void addVerify(CLI::App& app, ExitCode& exit_code);
void addReduce(CLI::App& app, ExitCode& exit_code);
void addDiff(CLI::App& app, ExitCode& exit_code);
void addPlot(CLI::App& app, ExitCode& exit_code);
void addExplore(CLI::App& app, ExitCode& exit_code);
void addAnalyze(CLI::App& app, ExitCode& exit_code);
void addTerminalSet(CLI::App& app, ExitCode& exit_code);
void addSet(CLI::App& app, ExitCode& exit_code);
void addExport(CLI::App& app, ExitCode& exit_code);
void addCondense(CLI::App& app, ExitCode& exit_code);

/// What an exploration that ended so returns to the shell.
ExitCode exitCode(ExploreStatus status);

/// The option --threads, whose default is all processors.
void addThreads(CLI::App& command, int& threads);

/// The option --time-limit, without which there is no limit.
void addTimeLimit(CLI::App& command, double& time_limit);

/// Number of processors, at least 1; under an MPI launcher this process's share of them.
int defaultThreads();

/// Prints what the author of the problem may not have meant, a line each, on standard error.
void printRemarks(const std::string& problem, const ParametricProgram& program);

/// Of an error that names the program, one that names `file`, from which it was read.
Error namingFile(const Error& error, const ParametricProgram& program, const std::string& file);

/// Calls `work`. Its errors that name the program name `file`.
template <typename Work>
auto inFile(const std::string& file, const ParametricProgram& program, const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw namingFile(error, program, file);
  }
}

/// Writes a text as writeFileAtomically does. Throws Error.
void writeText(const std::string& path, const std::string& text);

}  // namespace polyfly
