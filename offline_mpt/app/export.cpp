#include <cstdio>
#include <map>
#include <memory>
#include <utility>

#include "command.hpp"
#include "export_online.hpp"
#include "export_proven/export_proven.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/visible.hpp"
#include "progress.hpp"
#include "region_maps/region_map.hpp"
#include "signals.hpp"

namespace polyfly {
namespace {

const char kExportFooter[] =
    R"(Writes four files to DIR:

  NAME.h       Functions, statuses, signals, and what is proven of the answers.
  NAME.c       Constant tables and the look-up. C99, also valid C++.
  NAME_test.c  A program that returns 0 where the compiled code answers as the map does.
  NAME.json    Bytes of flash and stack, greatest numbers of operations, bounds, checksums.

--type double answers as the map does, bit for bit. --type float answers within a bound that the command
proves. Where a bound cannot be proven, nothing is written. region_maps/region_maps/export/README.md says what is proven.

With --flash-limit, code whose flash_bytes in NAME.json exceed the limit is not written: tables and
instructions, on the processor that needs more of these. --type float and 'offline_mpt reduce' make it smaller.

--online writes code that solves the problem for each parameter instead: small where the map does not fit, but
slower, and without a proof. MAP may be a problem file then.

Examples:
  offline_mpt export lateral.map -o code --name lateral
  offline_mpt export lateral.map -o code --name lateral --type float
  offline_mpt export lateral.map -o code --name lateral --flash-limit 16k
  offline_mpt export lateral.map -o code --name lateral --online --type float
  check_certificate --export code --map lateral.map
  cc -std=c99 -ffp-contract=off code/lateral.c code/lateral_test.c -o lateral_test && ./lateral_test)";

struct ExportArguments {
  std::string map;
  std::string folder;
  std::string name;
  ExportType type = ExportType::kDouble;
  /// Greatest FlashBytes::total(); 0: none. [bytes]
  std::uint64_t flash_limit = 0;
  double time_limit = 0.0;
  bool quiet = false;
  bool is_online = false;
  /// Of --online. 0: the solver's default.
  std::uint32_t iteration_limit = 0;
};

/// Where the code differs from the map, by how much at most.
void printErrors(const RegionMap& map, const ProvenExport& proven) {
  if (proven.options.type == ExportType::kDouble) return;
  for (std::size_t j = 0; j < map.inputs().size(); ++j) {
    const Signal& input = map.inputs()[j];
    std::printf("  %s: off the map's by at most %.6g %s\n", visible(input.name).c_str(),
                proven.bound.error[j], visible(input.unit).c_str());
  }
}

ExitCode exportMap(const ExportArguments& arguments) {
  const std::string& name = arguments.name;
  if (arguments.is_online) {
    if (arguments.flash_limit != 0) throw Error("--flash-limit: is of maps, not of --online");
    exportOnline({arguments.map, arguments.folder, {name, arguments.type, arguments.iteration_limit}});
    return ExitCode::kDone;
  }
  if (arguments.iteration_limit != 0) throw Error("--iteration-limit: needs --online");
  checkExportOutputs(arguments.folder, name, {arguments.map});
  // Of no phase anything can be kept.
  endOnSignal(arguments.folder + ": interrupted: nothing was written", arguments.time_limit);
  const RegionMap map = RegionMap::open(arguments.map);
  Progress progress(arguments.quiet);
  ExportOptions options;
  options.name = name;
  options.type = arguments.type;
  ExportProofOptions proof;
  proof.progress = [&progress](std::uint64_t pairs) {
    progress.show("proof: compared " + std::to_string(pairs) + " pairs of leaves");
  };
  const ProvenExport proven = proveExport(map, std::move(options), proof);
  progress.finish();
  const std::size_t bytes = exportFlashBytes(map, proven.options).total();
  if (arguments.flash_limit != 0 && bytes > arguments.flash_limit) {
    throw Error("--flash-limit: of " + arguments.map + ", the code in " + toString(arguments.type) +
                " needs " + std::to_string(bytes) +
                " bytes; --type float and 'offline_mpt reduce' make it smaller");
  }
  ignoreSignals();
  writeExport(map, proven, arguments.folder);
  if (!arguments.quiet) {
    std::printf("%s/%s.c: %zu bytes of flash, in %s\n", arguments.folder.c_str(), name.c_str(), bytes,
                toString(arguments.type));
    printErrors(map, proven);
  }
  if (!proven.bound.isAllowed()) {
    std::fprintf(
        stderr,
        "offline_mpt: %s/%s.c: its error exceeds what the safety filter's proof allows; raise `error` of "
        "the inputs\n",
        arguments.folder.c_str(), name.c_str());
  }
  return ExitCode::kDone;
}

}  // namespace

void addExport(CLI::App& app, ExitCode& exit_code) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App* command = app.add_subcommand("export", "Write a map as C code.");
  command->footer(kExportFooter);
  command->add_option("MAP", arguments->map, "Map file.")->required();
  command->add_option("-o,--output", arguments->folder, "Folder to write to. It is made where it is missing.")
      ->required();
  command->add_option("--name", arguments->name, "Prefix of files and identifiers: letters, digits, _.")
      ->required();
  const std::map<std::string, ExportType> types = {{"double", ExportType::kDouble},
                                                   {"float", ExportType::kFloat}};
  const CLI::Validator removed(
      [](const std::string& word) { return word == "int16" ? std::string(kNoInt16) : std::string(); }, "");
  command->add_option("--type", arguments->type, "Type of all numbers: double or float (default: double).")
      ->transform(oneOf(types))
      ->transform(removed);
  command
      ->add_option("--flash-limit", arguments->flash_limit,
                   "Greatest size of tables and instructions in bytes; suffixes k, M, G (default: no limit).")
      ->transform(byteCount(1));
  command->add_flag("--online", arguments->is_online, "Write a solver instead of the map's look-up.");
  command
      ->add_option("--iteration-limit", arguments->iteration_limit,
                   "Changes of the active set that one solution may make, 1 .. 65535 (default: 10 for each "
                   "variable and "
                   "row, and 30).")
      ->check(wholeNumber(1, 65535));
  addTimeLimit(*command, arguments->time_limit);
  command->add_flag("--quiet", arguments->quiet, "Print nothing but errors.");
  command->callback([arguments, &exit_code] { exit_code = exportMap(*arguments); });
}

}  // namespace polyfly
