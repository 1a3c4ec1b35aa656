#include <cstdio>
#include <map>
#include <memory>

#include "command.hpp"
#include "map_export/export_map.hpp"

namespace polyfly {
namespace {

const char kExportFooter[] =
    R"(Writes four files to DIR:

  NAME.h       Functions, statuses, signals, and what is proven of the answers.
  NAME.c       Constant tables and the look-up. C99, also valid C++.
  NAME_test.c  A program that returns 0 where the compiled code answers as the map does.
  NAME.json    Sizes of tables, greatest numbers of operations, bounds, checksums.

--type double answers as the map does, bit for bit.

Examples:
  offline_mpt export lateral.map -o code --name lateral
  cc -std=c99 -ffp-contract=off code/lateral.c code/lateral_test.c -o lateral_test && ./lateral_test)";

struct ExportArguments {
  std::string map;
  std::string folder;
  ExportOptions options;
};

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
  ExportBound bound;
  bound.error.assign(map.inputs().size(), 0.0);
  const std::string source = exportSource(map, arguments.options);
  makeFolder(arguments.folder);
  writeText(stem + ".c", source);
  writeText(stem + ".h", exportHeader(map, arguments.options, bound));
  writeText(stem + "_test.c", exportTest(map, arguments.options, bound));
  writeText(stem + ".json", exportFacts(map, arguments.options, bound));
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
  const std::map<std::string, ExportType> types = {{"double", ExportType::kDouble}};
  command->add_option("--type", arguments->options.type, "Type of all numbers: double (default: double).")
      ->transform(oneOf(types));
  command->callback([arguments, &exit_code] { exit_code = exportMap(*arguments); });
}

}  // namespace polyfly
