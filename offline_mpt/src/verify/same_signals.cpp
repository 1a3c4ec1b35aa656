#include "verify/same_signals.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

/// Both may be infinite: no bound.
bool isSameBound(double in_map, double in_program, double difference) {
  if (!std::isfinite(in_map) || !std::isfinite(in_program)) return in_map == in_program;
  return std::abs(in_map - in_program) <= difference * std::max(1.0, std::abs(in_program));
}

void requireSame(const std::string& what, const std::vector<Signal>& in_map,
                 const std::vector<Signal>& in_program, double range_difference) {
  if (in_map.size() != in_program.size()) {
    throw Error(what + "s: the map has " + std::to_string(in_map.size()) + ", the problem has " +
                std::to_string(in_program.size()));
  }
  for (std::size_t i = 0; i < in_map.size(); ++i) {
    const Signal &a = in_map[i], &b = in_program[i];
    const std::string place = what + " " + std::to_string(i + 1) + ": ";
    if (a.name != b.name)
      throw Error(place + "the map has '" + a.name + "', the problem has '" + b.name + "'");
    if (a.unit != b.unit)
      throw Error(place + "the map has the unit '" + a.unit + "', the problem has '" + b.unit + "'");
    if (!isSameBound(a.lower, b.lower, range_difference) || !isSameBound(a.upper, b.upper, range_difference))
      throw Error(what + " '" + a.name + "': the ranges of map and problem differ");
  }
}

}  // namespace

void requireSameSignals(const RegionMap& map, const ParametricProgram& program, double range_difference) {
  requireSame(map.path() + ": parameter", map.parameters(), program.parameters, range_difference);
  requireSame(map.path() + ": input", map.inputs(), program.inputs, range_difference);
  if (map.period() != program.period)
    throw Error(map.path() + ": period: must be that of the problem, " + std::to_string(program.period) +
                " s, got " + std::to_string(map.period()) + " s");
}

}  // namespace polyfly
