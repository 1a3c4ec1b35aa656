#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "command.hpp"
#include "export_online.hpp"
#include "export_proven/export_proven.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

const char kExportFooter[] =
    R"(Writes four files to DIR:

  NAME.h       Functions, statuses, signals, and what is proven of the answers.
  NAME.c       Constant tables and the look-up. C99, also valid C++.
  NAME_test.c  A program that returns 0 where the compiled code answers as the map does.
  NAME.json    Sizes of tables, greatest numbers of operations, bounds, checksums.

--type double answers as the map does, bit for bit. --type float answers within a bound that the command
proves. Where it cannot, nothing is written. region_maps/export/README.md says what is proven.

--online writes code that solves the problem for each parameter instead: small where the map does not fit, but
slower, and without a proof. MAP may be a problem file then.

Examples:
  offline_mpt export lateral.map -o code --name lateral
  offline_mpt export lateral.map -o code --name lateral --type float
  offline_mpt export lateral.map -o code --name lateral --online --type float
  check_certificate --export code --map lateral.map
  cc -std=c99 -ffp-contract=off code/lateral.c code/lateral_test.c -o lateral_test && ./lateral_test)";

struct ExportArguments {
  std::string map;
  std::string folder;
  ExportOptions options;
  /// 0: none. [bytes]
  std::uint64_t flash_limit = 0;
  bool chooses_type = false;
  bool is_online = false;
  /// 0: the solver's default.
  std::uint32_t iteration_limit = 0;
};

/// The asked type, or else the first of double and float whose tables fit the limit.
ProvenExport fittingExport(const RegionMap& map, const ExportArguments& arguments) {
  std::vector<ExportType> types = {arguments.options.type};
  if (arguments.chooses_type) types = {ExportType::kDouble, ExportType::kFloat};
  std::string needs;
  for (const ExportType type : types) {
    ExportOptions options = arguments.options;
    options.type = type;
    ProvenExport result = proveExport(map, std::move(options));
    const std::size_t bytes = exportTableBytes(map, result.options);
    if (arguments.flash_limit == 0 || bytes <= arguments.flash_limit) return result;
    needs += (needs.empty() ? "" : ", ") + std::to_string(bytes) + " bytes in " +
             (type == ExportType::kDouble ? "double" : "float");
  }
  throw Error("--flash-limit: the tables of " + map.path() + " need " + needs +
              "; `offline_mpt reduce` may write a smaller map");
}

ExitCode exportMap(const ExportArguments& arguments) {
  if (arguments.is_online) {
    if (arguments.flash_limit != 0) throw Error("--flash-limit: is of maps, not of --online");
    exportOnline({arguments.map,
                  arguments.folder,
                  {arguments.options.name, arguments.options.type, arguments.iteration_limit}});
    return ExitCode::kDone;
  }
  if (arguments.iteration_limit != 0) throw Error("--iteration-limit: needs --online");
  checkExportOutputs(arguments.folder, arguments.options.name, {arguments.map});
  const RegionMap map = RegionMap::open(arguments.map);
  writeExport(map, fittingExport(map, arguments), arguments.folder);
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
  command
      ->add_option("--name", arguments->options.name, "Prefix of files and identifiers: letters, digits, _.")
      ->required();
  const std::map<std::string, ExportType> types = {{"double", ExportType::kDouble},
                                                   {"float", ExportType::kFloat}};
  command
      ->add_option("--type", arguments->options.type,
                   "Type of all numbers: double or float (default: double).")
      ->transform(oneOf(types));
  CLI::Option* const type = command->get_option("--type");
  command
      ->add_option(
          "--flash-limit", arguments->flash_limit,
          "Greatest size of the tables in bytes; suffixes k, M, G (default: no limit). Without --type, "
          "double is taken where it fits, else float.")
      ->transform(byteCount(1));
  command->add_flag("--online", arguments->is_online, "Write a solver instead of the map's look-up.");
  command
      ->add_option("--iteration-limit", arguments->iteration_limit,
                   "Changes of the active set that one solution may make, 1 .. 65535 (default: 10 for each "
                   "variable and "
                   "row, and 30).")
      ->check(wholeNumber(1, 65535));
  command->callback([arguments, type, &exit_code] {
    arguments->chooses_type = arguments->flash_limit != 0 && type->count() == 0;
    exit_code = exportMap(*arguments);
  });
}

}  // namespace polyfly
