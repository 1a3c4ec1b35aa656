#include "validation/map_proposal.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <exception>
#include <iomanip>
#include <locale>
#include <new>
#include <sstream>

#include "mpc_core/mpc_problem.hpp"
#include "polyfly_base/error.hpp"
#include "polyfly_base/load_yaml.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

// Outwards to three significant digits, as people write ranges.
double roundedOut(double value, bool up) {
  if (value == 0.0) return 0.0;
  const double unit = std::pow(10.0, std::floor(std::log10(std::abs(value))) - 2.0);
  return (up ? std::ceil(value / unit) : std::floor(value / unit)) * unit;
}

std::vector<MapProposal::Change> changesOf(const MapUse& use) {
  std::vector<MapProposal::Change> changes;
  for (const ParameterUse& parameter : use.parameters) {
    const auto [lower, upper] = parameter.proposedRange();
    if (lower == parameter.lower && upper == parameter.upper) continue;
    changes.push_back({parameter.name,
                       parameter.unit,
                       {parameter.lower, parameter.upper},
                       {lower == parameter.lower ? lower : roundedOut(lower, false),
                        upper == parameter.upper ? upper : roundedOut(upper, true)}});
  }
  return changes;
}

// The text with the range of one parameter replaced; all else, comments too, stays as it is.
std::string withRange(const std::string& text, const MapProposal::Change& change) {
  const YAML::Node parameters = loadYaml(text, "the map's problem")["parameters"];
  for (const YAML::Node& parameter : parameters) {
    if (!parameter["name"] || parameter["name"].as<std::string>() != change.parameter) continue;
    const YAML::Node range = parameter["range"];
    const auto begin = range ? static_cast<std::size_t>(range.Mark().pos) : text.size();
    const std::size_t end =
        begin < text.size() && text[begin] == '[' ? text.find(']', begin) : std::string::npos;
    if (end == std::string::npos) break;
    std::ostringstream list;
    list.imbue(std::locale::classic());
    list << std::setprecision(10) << "[" << change.to[0] << ", " << change.to[1] << "]";
    return text.substr(0, begin) + list.str() + text.substr(end + 1);
  }
  throw Error("parameters: " + change.parameter +
              ": no `range: [least, greatest]` to change in the map's problem");
}

}  // namespace

std::optional<MapProposal> proposeMap(const RegionMap& map, const MapUse& use, const std::string& axis) {
  MapProposal proposal;
  proposal.axis = axis;
  proposal.map_path = map.path();
  proposal.changes = changesOf(use);
  proposal.infeasible = use.outside_partition;
  if (proposal.changes.empty() && proposal.infeasible == 0) return std::nullopt;
  if (proposal.changes.empty()) {
    proposal.obstacle =
        "no range covers these samples: the problem has no solution there; its bounds on states or its "
        "horizon must change";
    return proposal;
  }
  try {
    std::string text(map.problemText());
    for (const MapProposal::Change& change : proposal.changes) text = withRange(text, change);
    // What is proposed must be a problem.
    if (map.problemKind() == "yaml") parseFlightModel(text, map.path() + " (proposal)");
    proposal.problem = text;
  } catch (const std::bad_alloc&) {  // is no property of the problem
    throw;
  } catch (const std::exception& error) {
    proposal.obstacle = error.what();
  }
  return proposal;
}

}  // namespace polyfly
