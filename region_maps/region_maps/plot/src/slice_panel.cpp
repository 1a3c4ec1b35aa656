#include <algorithm>
#include <cmath>
#include <iomanip>
#include <limits>
#include <sstream>

#include "clip.hpp"
#include "map_plot/slice.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

// From blue over near-white to orange: light or dark by magnitude and distinct by hue for every kind of
// colour vision.
const std::vector<std::string> kColors = {"#08519c", "#2f79b5", "#6aa5d1", "#a5cae4", "#d5e5f1", "#f4f4f2",
                                          "#fbe3c8", "#f7c48f", "#ec9d55", "#d67528", "#a8500a"};

// The first input as an affine function of the slice's coordinates: value = a x + b y + c.
struct Plane {
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;
  double at(const std::pair<double, double>& point) const { return a * point.first + b * point.second + c; }
};

Plane firstInput(const RegionMap& map, const Slice& cut, std::uint32_t law_index) {
  const double* law = map.law(law_index);
  const int count = static_cast<int>(map.parameters().size());
  Plane plane;
  plane.c = law[count];
  for (int index = 0; index < count; ++index) {
    if (index == cut.x) {
      plane.a = law[index];
    } else if (index == cut.y) {
      plane.b = law[index];
    } else {
      plane.c += law[index] * cut.theta[static_cast<std::size_t>(index)];
    }
  }
  return plane;
}

// The range of the first input over the slice, widened where it is a single value.
std::pair<double, double> inputRange(const RegionMap& map, const Slice& cut) {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -lower;
  for (const SlicePolygon& polygon : cut.polygons) {
    const Plane input = firstInput(map, cut, polygon.law);
    for (const auto& corner : polygon.corners) {
      lower = std::min(lower, input.at(corner));
      upper = std::max(upper, input.at(corner));
    }
  }
  if (!std::isfinite(lower)) {
    return {-1.0, 1.0};
  }
  // The middle colour means zero if the range holds zero.
  if (lower < 0.0 && upper > 0.0) {
    upper = std::max(upper, -lower);
    lower = -upper;
  }
  const double least_width = 1e-9 * std::max({1.0, std::abs(lower), std::abs(upper)});
  return upper - lower > least_width ? std::make_pair(lower, upper)
                                     : std::make_pair(lower - 0.5, upper + 0.5);
}

// Every polygon is cut into bands of the input's value, so that the colours show the law and not only the
// region.
std::vector<Patches> inputBands(const RegionMap& map, const Slice& cut, std::pair<double, double> range) {
  const auto count = kColors.size();
  std::vector<Patches> bands(count);
  for (std::size_t band = 0; band < count; ++band) {
    const double low =
        range.first + (range.second - range.first) * static_cast<double>(band) / static_cast<double>(count);
    const double high = range.first + (range.second - range.first) * static_cast<double>(band + 1) /
                                          static_cast<double>(count);
    for (const SlicePolygon& polygon : cut.polygons) {
      const Plane input = firstInput(map, cut, polygon.law);
      Ring ring = polygon.corners;
      if (band > 0) ring = clip(ring, -input.a, -input.b, input.c - low);
      if (band + 1 < count) ring = clip(ring, input.a, input.b, high - input.c);
      if (ring.size() > 2) bands[band].polygons.push_back(std::move(ring));
    }
    // The border hides the seams of anti-aliasing.
    bands[band].fill = bands[band].border = kColors[band];
    bands[band].width = 0.4;
  }
  bands.erase(
      std::remove_if(bands.begin(), bands.end(), [](const Patches& band) { return band.polygons.empty(); }),
      bands.end());
  return bands;
}

std::string sliceTitle(const RegionMap& map, const Slice& cut) {
  return std::string(map.name()) + ": " + std::to_string(cut.polygons.size()) + " of " +
         std::to_string(map.regionCount()) + " regions";
}

// The values of the parameters that the slice holds fixed.
std::string fixedParameters(const RegionMap& map, const Slice& cut) {
  std::ostringstream text;
  text.imbue(std::locale::classic());
  const char* separator = "at ";
  for (std::size_t index = 0; index < map.parameters().size(); ++index) {
    if (static_cast<int>(index) == cut.x || static_cast<int>(index) == cut.y) continue;
    text << separator << map.parameters()[index].name << " = " << std::setprecision(3) << cut.theta[index];
    separator = ", ";
  }
  return text.str();
}

}  // namespace

std::string axisLabel(const Signal& signal) { return signal.name + " [" + signal.unit + "]"; }

Panel slicePanel(const RegionMap& map, const Slice& cut) {
  const Signal& x = map.parameters()[static_cast<std::size_t>(cut.x)];
  const Signal& y = map.parameters()[static_cast<std::size_t>(cut.y)];
  Panel panel;
  panel.title = sliceTitle(map, cut);
  panel.subtitle = fixedParameters(map, cut);
  panel.x_label = axisLabel(x);
  panel.y_label = axisLabel(y);
  panel.x_range = cut.x_range;
  panel.y_range = cut.y_range;
  if (!map.inputs().empty()) {
    const auto range = inputRange(map, cut);
    panel.patches = inputBands(map, cut, range);
    panel.scale = ColorScale{range.first, range.second, axisLabel(map.inputs().front()), kColors};
  }
  Patches outlines;
  for (const SlicePolygon& polygon : cut.polygons) {
    outlines.polygons.push_back(polygon.corners);
  }
  outlines.border = "#9aa5b0";
  outlines.width = 0.8;
  panel.patches.push_back(std::move(outlines));
  return panel;
}

Figure sliceFigure(const RegionMap& map, const SliceRequest& request) {
  Figure figure;
  figure.width = 860;
  figure.height = 640;
  figure.panels = {slicePanel(map, slice(map, request))};
  return figure;
}

void plotSlice(const RegionMap& map, const SliceRequest& request, const std::string& file) {
  writeFigure(sliceFigure(map, request), file);
}

}  // namespace polyfly
