#include <memory>
#include <optional>

#include "command.hpp"
#include "map_plot/slice.hpp"
#include "polyfly_base/decimal.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

const char kPlotFooter[] =
    R"(Two parameters are on the axes. The others have the value of --at, else 0 if their range contains it, else
the middle of their range. The colour of a region is the value of the first input. The command needs
gnuplot.

Examples:
  offline_mpt plot lateral.map --slice e_p,e_v -o lateral.svg
  offline_mpt plot lateral.map --slice e_p,e_v --at u_ref=0.1 --at u_prev=0.1 -o lateral.png)";

struct PlotArguments {
  std::string map;
  std::string axes;
  std::vector<std::string> at;
  std::string output;
};

SliceRequest request(const PlotArguments& options) {
  SliceRequest result;
  const std::size_t comma = options.axes.find(',');
  if (comma == std::string::npos || options.axes.find(',', comma + 1) != std::string::npos) {
    throw Error("--slice: must be two parameter names with a comma between, got '" + options.axes + "'");
  }
  result.x = options.axes.substr(0, comma);
  result.y = options.axes.substr(comma + 1);
  for (const std::string& entry : options.at) {
    const std::size_t equals = entry.find('=');
    const std::string number = equals == std::string::npos ? "" : entry.substr(equals + 1);
    const std::optional<double> value = decimalNumber(number);
    if (!value) throw Error("--at: must be name=number, got '" + entry + "'" + kDecimalRule);
    result.at.emplace_back(entry.substr(0, equals), *value);
  }
  return result;
}

ExitCode plot(const PlotArguments& options) {
  const SliceRequest slice_request = request(options);
  checkOutputs({{options.output}}, {options.map});
  plotSlice(RegionMap::open(options.map), slice_request, options.output);
  return ExitCode::kDone;
}

}  // namespace

void addPlot(CLI::App& app, ExitCode& exit_code) {
  auto options = std::make_shared<PlotArguments>();
  CLI::App* command = app.add_subcommand("plot", "Plot a slice through a map's regions.");
  command->footer(kPlotFooter);
  command->add_option("MAP", options->map, "Map file.")->required();
  command->add_option("--slice", options->axes, "Names of the two parameters on the axes: x,y.")->required();
  command->add_option("--at", options->at, "Value of another parameter: name=value. May be repeated.")
      ->expected(1)
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  command->add_option("-o,--output", options->output, "Plot file to write, .svg or .png.")->required();
  command->callback([options, &exit_code] { exit_code = plot(*options); });
}

}  // namespace polyfly
