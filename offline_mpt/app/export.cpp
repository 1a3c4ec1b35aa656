#include <cstdio>
#include <map>
#include <memory>
#include <vector>

#include "command.hpp"
#include "export_bound.hpp"
#include "map_export/export_map.hpp"
#include "polyfly_base/error.hpp"

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

Examples:
  offline_mpt export lateral.map -o code --name lateral
  offline_mpt export lateral.map -o code --name lateral --type float
  check_certificate --export code --map lateral.map
  cc -std=c99 -ffp-contract=off code/lateral.c code/lateral_test.c -o lateral_test && ./lateral_test)";

struct ExportArguments {
  std::string map;
  std::string folder;
  ExportOptions options;
  /// 0: none. [bytes]
  std::uint64_t flash_limit = 0;
  bool chooses_type = false;
};

/// The checker proves the bound. It reads the code's text and shares nothing with what wrote it. Where the code may
/// have no answer though the map has one, its leaves get more candidates; failing that, it gets a greater tolerance.
ExportBound proveExport(const RegionMap& map, ExportOptions& options) {
  constexpr int kRounds = 4;
  constexpr double kGrowth = 4.0;
  try {
    const checker::Map checked(checker::readFile(map.path()));
    for (int round = 0; round < kRounds; ++round, options.tolerance *= kGrowth) {
      options.extra.clear();
      for (const bool is_repaired : {false, true}) {
        const checker::ExportedAnswers proven =
            checker::exportedAnswers(checked, checker::readCode(exportSource(map, options)));
        if (proven.missing.empty()) return {proven.error, proven.margin};
        if (is_repaired) break;
        for (const auto& [leaf, region] : proven.missing) options.extra.push_back({leaf, region});
      }
    }
  } catch (const checker::Refused& refused) {
    throw Error(map.path() + ": its code could not be proven: " + refused.what());
  }
  throw Error(map.path() +
              ": its code could not be proven: rounding may find no region where the map has one");
}

struct Export {
  ExportOptions options;
  ExportBound bound;
};

/// The asked type, or else the first of double and float whose tables fit the limit.
Export fittingExport(const RegionMap& map, const ExportArguments& arguments) {
  std::vector<ExportType> types = {arguments.options.type};
  if (arguments.chooses_type) types = {ExportType::kDouble, ExportType::kFloat};
  std::string needs;
  for (const ExportType type : types) {
    Export result = {arguments.options, {}};
    result.options.type = type;
    result.bound = proveExport(map, result.options);
    const std::size_t bytes = exportTableBytes(map, result.options);
    if (arguments.flash_limit == 0 || bytes <= arguments.flash_limit) return result;
    needs += (needs.empty() ? "" : ", ") + std::to_string(bytes) + " bytes in " +
             (type == ExportType::kDouble ? "double" : "float");
  }
  throw Error("--flash-limit: the tables of " + map.path() + " need " + needs +
              "; `offline_mpt reduce` may write a smaller map");
}

ExitCode exportMap(const ExportArguments& arguments) {
  checkExportName(arguments.options.name);
  const std::string stem = arguments.folder + "/" + arguments.options.name;
  const Output::Folder made = Output::Folder::kIsMade;
  checkOutputs({{stem + ".c", Output::Kind::kText, made},
                {stem + ".h", Output::Kind::kText, made},
                {stem + "_test.c", Output::Kind::kText, made},
                {stem + ".json", Output::Kind::kText, made}},
               {arguments.map});
  const RegionMap map = RegionMap::open(arguments.map);
  const auto [options, bound] = fittingExport(map, arguments);
  makeFolder(arguments.folder);
  writeText(stem + ".c", exportSource(map, options));
  writeText(stem + ".h", exportHeader(map, options, bound));
  writeText(stem + "_test.c", exportTest(map, options, bound));
  writeText(stem + ".json", exportFacts(map, options, bound));
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
  command->callback([arguments, type, &exit_code] {
    arguments->chooses_type = arguments->flash_limit != 0 && type->count() == 0;
    exit_code = exportMap(*arguments);
  });
}

}  // namespace polyfly
