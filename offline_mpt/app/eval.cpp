#include <cstdio>
#include <memory>

#include "command.hpp"
#include "csv.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

const char kEvalFooter[] =
    R"(THETAS.csv has one parameter vector per row. A first row may name the columns, in any order. Without it
they are in the order of `offline_mpt info MAP`. Lines that start with # are ignored.

The output has one row per vector: status (inside, outside_box, outside_partition, not_finite), region,
and the inputs by name. Region and inputs are empty if the status is not `inside`.

Examples:
  offline_mpt eval lateral.map --csv thetas.csv
  offline_mpt eval lateral.map --csv thetas.csv -o commands.csv)";

struct EvalArguments {
  std::string map;
  std::string csv;
  std::string output;
};

const char* statusName(LookupStatus status) {
  switch (status) {
    case LookupStatus::kInside:
      return "inside";
    case LookupStatus::kOutsideBox:
      return "outside_box";
    case LookupStatus::kOutsidePartition:
      return "outside_partition";
    case LookupStatus::kNotFinite:
      return "not_finite";
  }
  return "unknown";
}

std::string evaluateRows(const RegionMap& map, const std::vector<std::vector<double>>& thetas) {
  std::string text = "status,region";
  for (const Signal& input : map.inputs()) text += "," + input.name;
  text += '\n';
  std::vector<double> u(map.inputs().size());
  char number[32];
  for (const std::vector<double>& theta : thetas) {
    const Lookup lookup = map.evaluate(theta.data(), u.data());
    const bool inside = lookup.status == LookupStatus::kInside;
    text += statusName(lookup.status);
    text += ',';
    if (inside) text += std::to_string(lookup.region);
    for (const double value : u) {
      text += ',';
      if (!inside) continue;
      std::snprintf(number, sizeof number, "%.17g", value);
      text += number;
    }
    text += '\n';
  }
  return text;
}

ExitCode eval(const EvalArguments& options) {
  checkOutputs({{options.output}}, {options.map, options.csv});
  const RegionMap map = RegionMap::open(options.map);
  std::vector<std::string> names;
  for (const Signal& parameter : map.parameters()) names.push_back(parameter.name);
  const std::string text = evaluateRows(map, readCsv(options.csv, names));
  if (!options.output.empty()) {
    writeText(options.output, text);
  } else if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0) {
    throw Error("standard output: cannot be written");
  }
  return ExitCode::kDone;
}

}  // namespace

void addEval(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<EvalArguments>();
  CLI::App* command = app.add_subcommand("eval", "Look up parameter vectors from a CSV file.");
  command->footer(kEvalFooter);
  command->add_option("MAP", options->map, "Map file.")->required();
  command->add_option("--csv", options->csv, "CSV file with one parameter vector per row.")->required();
  command->add_option("-o,--output", options->output, "CSV file to write (default: standard output).");
  command->callback([options, &exit_code] { exit_code = eval(*options); });
}

}  // namespace polyfly
