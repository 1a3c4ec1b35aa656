#include <memory>

#include "command.hpp"
#include "csv.hpp"
#include "explorer_content/explorer_content.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

const char kExploreFooter[] =
    R"(The page needs no network and no other file. Any browser of the last years opens it, from disk too. It
shows slices of the map, what holds at a point, and the flight from there with the model of the problem.

SAMPLES.csv adds a recorded flight: one row per sample, with columns t [s] and the map's parameters. A
first row may name the columns, in any order. Without it they are t and the parameters as in
`offline_mpt info MAP`.

Examples:
  offline_mpt explore lateral.map -o lateral.html
  offline_mpt explore lateral.map --samples flight.csv -o lateral.html)";

struct ExploreArguments {
  std::string map;
  std::string samples;
  std::string output;
};

ExplorerFlight readFlight(const std::string& path, const RegionMap& map) {
  std::vector<std::string> names = {"t"};
  for (const Signal& parameter : map.parameters()) names.push_back(parameter.name);
  ExplorerFlight flight;
  flight.source = path.substr(path.find_last_of('/') + 1);
  for (const std::vector<double>& row : readCsv(path, names)) {
    flight.times.push_back(row.front());
    flight.thetas.insert(flight.thetas.end(), row.begin() + 1, row.end());
  }
  return flight;
}

ExitCode explorePage(const ExploreArguments& options) {
  checkOutputs({{options.output}}, {options.map, options.samples});
  const RegionMap map = RegionMap::open(options.map);
  ExplorerContent content = explorerContent(map);
  if (!options.samples.empty()) content.flight = readFlight(options.samples, map);
  writeText(options.output, explorerPage(map, content));
  return ExitCode::kDone;
}

}  // namespace

void addExplore(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<ExploreArguments>();
  CLI::App* command = app.add_subcommand("explore", "Write a page that shows a map in a browser.");
  command->footer(kExploreFooter);
  command->add_option("MAP", options->map, "Map file.")->required();
  command->add_option("--samples", options->samples, "CSV file with the samples of a flight.");
  command->add_option("-o,--output", options->output, "HTML file to write.")->required();
  command->callback([options, &exit_code] { exit_code = explorePage(*options); });
}

}  // namespace polyfly
