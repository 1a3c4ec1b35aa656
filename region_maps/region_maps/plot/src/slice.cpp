#include "map_plot/slice.hpp"

#include <algorithm>
#include <cmath>

#include "clip.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

// Least area of a polygon worth drawing, in units of the rectangle's area.
constexpr double kLeastArea = 1e-12;
// Greatest coefficient of a plane that is parallel to the slice, in scaled parameters.
constexpr double kVanishingCoefficient = 1e-12;

int indexOf(const RegionMap& map, const std::string& name) {
  const auto& parameters = map.parameters();
  const auto found = std::find_if(parameters.begin(), parameters.end(),
                                  [&name](const Signal& signal) { return signal.name == name; });
  if (found == parameters.end()) {
    std::string known;
    for (const Signal& signal : parameters) {
      known += (known.empty() ? "" : ", ") + signal.name;
    }
    throw Error(map.path() + ": slice: no parameter '" + name + "'; the map has " + known);
  }
  return static_cast<int>(found - parameters.begin());
}

double restingValue(const Signal& signal) {
  const bool holds_zero = signal.lower <= 0.0 && signal.upper >= 0.0;
  return holds_zero ? 0.0 : 0.5 * (signal.lower + signal.upper);
}

std::vector<double> fixedValues(const RegionMap& map, const SliceRequest& request, int x, int y) {
  std::vector<double> theta;
  for (const Signal& signal : map.parameters()) {
    theta.push_back(restingValue(signal));
  }
  std::vector<bool> given(theta.size(), false);
  given[static_cast<std::size_t>(x)] = given[static_cast<std::size_t>(y)] = true;
  for (const auto& [name, value] : request.at) {
    const auto index = static_cast<std::size_t>(indexOf(map, name));
    const Signal& signal = map.parameters()[index];
    if (given[index]) {
      throw Error(map.path() + ": slice: parameter '" + name + "' is already an axis or given before");
    }
    if (!(value >= signal.lower && value <= signal.upper)) {
      throw Error(map.path() + ": slice: " + name + " = " + std::to_string(value) + " is outside its range " +
                  std::to_string(signal.lower) + " to " + std::to_string(signal.upper) + " " + signal.unit);
    }
    theta[index] = value;
    given[index] = true;
  }
  return theta;
}

Panel::Range rangeOf(const RegionMap& map, int parameter) {
  const Signal& signal = map.parameters()[static_cast<std::size_t>(parameter)];
  if (!(signal.lower < signal.upper))
    throw Error(map.path() + ": slice: the range of " + signal.name + " is empty");
  return {signal.lower, signal.upper};
}

// The plane's trace in the slice, a x + b y <= c in units where x and y run from -1 to 1.
struct Trace {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
};

Trace trace(const RegionMap& map, const Slice& cut, std::int32_t row) {
  const auto plane_index = static_cast<std::size_t>(std::abs(row) - 1);
  const double sign = row > 0 ? 1.0 : -1.0;
  const double* plane = map.plane(plane_index);
  const int count = static_cast<int>(map.parameters().size());
  Trace result;
  result.c = sign * plane[count];
  for (int index = 0; index < count; ++index) {
    const double coefficient = sign * plane[index];
    if (index != cut.x && index != cut.y) {
      result.c -= coefficient * cut.theta[static_cast<std::size_t>(index)];
      continue;
    }
    const auto& [lower, upper] = index == cut.x ? cut.x_range : cut.y_range;
    (index == cut.x ? result.a : result.b) = coefficient * 0.5 * (upper - lower);
    result.c -= coefficient * 0.5 * (upper + lower);
  }
  return result;
}

Ring cutRegion(const RegionMap& map, const Slice& cut, const RegionView& region) {
  Ring ring = {{-1.0, -1.0}, {1.0, -1.0}, {1.0, 1.0}, {-1.0, 1.0}};
  for (std::uint32_t row = 0; row < region.row_count && !ring.empty(); ++row) {
    const Trace line = trace(map, cut, region.rows[row]);
    if (std::hypot(line.a, line.b) > kVanishingCoefficient) {
      ring = clip(ring, line.a, line.b, line.c);
    } else if (line.c < -map.tolerance()) {
      ring.clear();
    }
  }
  return ring;
}

}  // namespace

Slice slice(const RegionMap& map, const SliceRequest& request) {
  Slice cut;
  cut.x = indexOf(map, request.x);
  cut.y = indexOf(map, request.y);
  if (cut.x == cut.y) {
    throw Error(map.path() + ": slice: both axes are '" + request.x + "'");
  }
  cut.theta = fixedValues(map, request, cut.x, cut.y);
  cut.x_range = rangeOf(map, cut.x);
  cut.y_range = rangeOf(map, cut.y);
  const auto& [left, right] = cut.x_range;
  const auto& [low, high] = cut.y_range;
  for (std::size_t index = 0; index < map.regionCount(); ++index) {
    const RegionView region = map.region(index);
    Ring ring = cutRegion(map, cut, region);
    if (area(ring) < 4.0 * kLeastArea) {
      continue;
    }
    for (auto& [along_x, along_y] : ring) {
      along_x = 0.5 * (left + right) + 0.5 * (right - left) * along_x;
      along_y = 0.5 * (low + high) + 0.5 * (high - low) * along_y;
    }
    cut.polygons.push_back({static_cast<std::uint32_t>(index), region.law, std::move(ring)});
  }
  return cut;
}

}  // namespace polyfly
