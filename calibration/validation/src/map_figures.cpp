#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <set>

#include "flight_figures.hpp"
#include "map_plot/slice.hpp"
#include "online_controller/laws/axis.hpp"
#include "polyfly_base/quantile.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {
namespace {

// Greatest number of dots of a drawn cloud.
constexpr std::size_t kDots = 900;
// Greatest number of regions that are named beside the picture.
constexpr std::size_t kNamedRegions = 12;
// Least width of a part of a slice, in the parameter's unit.
constexpr double kLeastWidth = 0.02;
// Grid in which samples are counted.
constexpr int kColumns = 48;
constexpr int kRows = 32;
// From few samples to many, each twice the one before or more.
constexpr const char* kHeat[] = {"#fde725", "#7ad151", "#22a884", "#2a788e", "#414487", "#440154"};

// Regions over time. Each region that was visited has a line of its own; of many, evenly spaced ones are named.
Panel regionPanel(const ReportContent& content, std::size_t axis) {
  const AxisValidation& used = content.validation.axes[axis];
  std::set<std::int64_t> visited;
  for (const ReplaySample& sample : content.samples) {
    if (sample.report.axis[axis].region >= 0) visited.insert(sample.report.axis[axis].region);
  }
  const std::vector<std::int64_t> met(visited.begin(), visited.end());
  Panel panel = timePanel(
      used.axis + ": " + std::to_string(met.size()) + " of " + std::to_string(used.regions()) + " regions",
      "");
  panel.series = {overTime(content, "", kAxisColors[axis], [&](const ReplaySample& sample) {
    const std::int64_t region = sample.report.axis[axis].region;
    const auto line = std::lower_bound(met.begin(), met.end(), region);
    return region < 0 ? kNothing : static_cast<double>(std::distance(met.begin(), line));
  })};
  // Then there is nothing to fit a range to.
  if (met.empty())
    panel.x_range =
        padded(0.0, content.samples.back().state.stamp - content.samples.front().state.stamp, 1.0);
  panel.series[0].style = Series::Style::kSteps;
  const std::size_t step = met.size() / (kNamedRegions + 1) + 1;
  for (std::size_t line = 0; line < met.size(); line += step)
    panel.y_ticks.emplace_back(static_cast<double>(line), "region " + std::to_string(met[line]));
  panel.y_range = {-0.6, std::max(0.6, static_cast<double>(met.size()) - 0.4)};
  return panel;
}

ReportSection regionFigure(const ReportContent& content) {
  // Height of a panel's title and axis, and of a named region [px].
  constexpr std::size_t kFrame = 150;
  constexpr std::size_t kLine = 18;
  std::size_t lines = 0;
  std::vector<Panel> panels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    panels.push_back(regionPanel(content, axis));
    lines = std::max(lines, panels.back().y_ticks.size());
  }
  return pictured("Active region over time",
                  "Which region's law answered each sample, of the regions that were visited. A level line "
                  "means that one affine law flew all along, a jump that the set of active constraints "
                  "changed, a gap that there was no answer.",
                  std::move(panels), static_cast<int>(kFrame + kLine * lines));
}

// Parameters of an axis along the free parameters of a slice, of each sample.
struct Cloud {
  std::vector<double> x;
  std::vector<double> y;
};

Cloud cloudOf(const ReportContent& content, std::size_t axis, const Slice& cut) {
  Cloud cloud;
  for (const ReplaySample& sample : content.samples) {
    const AxisReport& report = sample.report.axis[axis];
    if (!sample.has_reference || report.size == 0) continue;
    cloud.x.push_back(report.theta[static_cast<std::size_t>(cut.x)]);
    cloud.y.push_back(report.theta[static_cast<std::size_t>(cut.y)]);
  }
  return cloud;
}

// The slice that shows a flight, through position and velocity error. Each other parameter is at its median over the
// samples inside the map. Without such samples it is at 0, or at the bound nearest to it.
SliceRequest flightSlice(const ReportContent& content, std::size_t axis) {
  SliceRequest request;
  request.x = kAxisNames[axis].position_error;
  request.y = kAxisNames[axis].velocity_error;
  const auto& parameters = content.maps[axis]->parameters();
  for (std::size_t parameter = 0; parameter < parameters.size(); ++parameter) {
    const Signal& signal = parameters[parameter];
    if (signal.name == request.x || signal.name == request.y) continue;
    std::vector<double> values;
    for (const ReplaySample& sample : content.samples) {
      const AxisReport& report = sample.report.axis[axis];
      if (report.lookup == LookupStatus::kInside) values.push_back(report.theta[parameter]);
    }
    request.at.emplace_back(signal.name,
                            std::clamp(quantileOf(std::move(values)), signal.lower, signal.upper));
  }
  return request;
}

// The slice around the points, none if they lie outside the map altogether.
std::optional<Slice> sliceNear(const RegionMap& map, SliceRequest request, const Slice& whole,
                               const Cloud& cloud) {
  if (cloud.x.empty()) return std::nullopt;
  const auto [left, right] = std::minmax_element(cloud.x.begin(), cloud.x.end());
  const auto [low, high] = std::minmax_element(cloud.y.begin(), cloud.y.end());
  request.x_window = padded(*left, *right, kLeastWidth);
  request.y_window = padded(*low, *high, kLeastWidth);
  const auto apart = [](const Panel::Range& one, const Panel::Range& other) {
    return one.second <= other.first || other.second <= one.first;
  };
  if (apart(*request.x_window, whole.x_range) || apart(*request.y_window, whole.y_range)) return std::nullopt;
  return slice(map, request);
}

// Dark dots on white ones, so that they are seen on every colour.
std::vector<Series> dotsOf(const Cloud& cloud) {
  Series points;
  points.color = palette::kInk;
  points.style = Series::Style::kPoints;
  points.width = 2.0;
  for (std::size_t i = 0; i < cloud.x.size(); i += cloud.x.size() / kDots + 1) {
    points.x.push_back(cloud.x[i]);
    points.y.push_back(cloud.y[i]);
  }
  if (points.x.empty()) return {};
  Series halo = points;
  halo.color = "#ffffff";
  halo.width = 2.0 * points.width;
  return {halo, points};
}

// Cells coloured by the logarithm of their samples, with the regions' outlines above.
Panel heatPanel(const RegionMap& map, const Slice& cut, const Cloud& cloud) {
  constexpr int kLevels = static_cast<int>(std::size(kHeat));
  const double width = (cut.x_range.second - cut.x_range.first) / kColumns;
  const double height = (cut.y_range.second - cut.y_range.first) / kRows;
  std::map<std::pair<int, int>, double> counts;
  double most = 1.0;
  for (std::size_t i = 0; i < cloud.x.size(); ++i) {
    const int column = static_cast<int>(std::floor((cloud.x[i] - cut.x_range.first) / width));
    const int row = static_cast<int>(std::floor((cloud.y[i] - cut.y_range.first) / height));
    if (column < 0 || column >= kColumns || row < 0 || row >= kRows) continue;
    most = std::max(most, ++counts[{column, row}]);
  }
  const double per_level = std::max(std::log(2.0), std::log(most) / kLevels);
  std::vector<Patches> levels(kLevels + 1);
  for (std::size_t level = 0; level < std::size(kHeat); ++level) levels[level].fill = kHeat[level];
  for (const auto& [cell, count] : counts) {
    const int level = std::min(kLevels - 1, static_cast<int>(std::log(count) / per_level));
    const double x = cut.x_range.first + width * cell.first;
    const double y = cut.y_range.first + height * cell.second;
    levels[static_cast<std::size_t>(level)].polygons.push_back(
        {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}});
  }
  levels.back().border = palette::kGrey;
  for (const SlicePolygon& polygon : cut.polygons) levels.back().polygons.push_back(polygon.corners);
  levels.erase(std::remove_if(levels.begin(), levels.end(),
                              [](const Patches& level) { return level.polygons.empty(); }),
               levels.end());
  Panel panel = slicePanel(map, cut);
  panel.patches = levels;
  ColorScale scale;
  scale.upper = kLevels * per_level / std::log(10.0);
  scale.label = "samples in a cell, log 10";
  scale.colors.assign(std::begin(kHeat), std::end(kHeat));
  panel.scale = scale;
  return panel;
}

ReportSection sliceFigure(const ReportContent& content, std::size_t axis) {
  const RegionMap& map = *content.maps[axis];
  const SliceRequest request = flightSlice(content, axis);
  const Slice cut = slice(map, request);
  const Cloud cloud = cloudOf(content, axis, cut);
  std::vector<Panel> panels = {slicePanel(map, cut)};
  panels[0].title = "Whole map: " + std::to_string(cut.polygons.size()) + " of " +
                    std::to_string(map.regionCount()) + " regions are cut";
  panels[0].series = dotsOf(cloud);
  panels.push_back(heatPanel(map, cut, cloud));
  panels.back().title = "Where the flight spent its time";
  const std::optional<Slice> closer = sliceNear(map, request, cut, cloud);
  if (closer) {
    panels.push_back(slicePanel(map, *closer));
    panels.back().title = "Where the flight was: " + std::to_string(closer->polygons.size()) + " regions";
    panels.back().series = dotsOf(cloud);
    panels.push_back(heatPanel(map, *closer, cloud));
    panels.back().title = "Where the flight was, and for how long";
  }
  return pictured(
      std::string("Partition, ") + kAxisNames[axis].axis + " axis",
      "A slice of the map through " + axisLabel(map.parameters()[static_cast<std::size_t>(cut.x)]) + " and " +
          axisLabel(map.parameters()[static_cast<std::size_t>(cut.y)]) +
          " with the other parameters at their median of the flight: lines part the regions, colour is the "
          "explicit law's answer, the dark dots are what the flight visited (it also moves off the slice). "
          "Right: samples in each cell of a grid, whatever the other parameters.",
      std::move(panels), row_height::kView, 2);
}

}  // namespace

std::vector<ReportSection> mapFigures(const ReportContent& content) {
  std::vector<ReportSection> figures = {regionFigure(content)};
  for (const std::size_t axis : {std::size_t{1}, std::size_t{0}, std::size_t{2}})
    figures.push_back(sliceFigure(content, axis));
  return figures;
}

}  // namespace polyfly
