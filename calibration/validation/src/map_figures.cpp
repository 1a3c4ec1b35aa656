#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <optional>
#include <set>

#include "map_plot/slice.hpp"
#include "online_controller/laws/axis.hpp"
#include "region_maps/region_map.hpp"
#include "report_parts.hpp"
#include "validation/flight_slice.hpp"

namespace polyfly {
namespace {

using Style = Series::Style;

// Greatest number of dots of a drawn cloud.
constexpr std::size_t kDots = 900;
// Greatest number of regions that are named beside the picture.
constexpr std::size_t kNamedRegions = 12;

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
  if (met.empty() && !content.samples.empty()) {  // nothing to fit a range to
    panel.x_range =
        padded(0.0, content.samples.back().state.stamp - content.samples.front().state.stamp, 1.0);
  }
  panel.series[0].style = Style::kSteps;
  panel.series[0].width = 2.2;
  const std::size_t step = met.size() / (kNamedRegions + 1) + 1;
  for (std::size_t line = 0; line < met.size(); line += step)
    panel.y_ticks.emplace_back(static_cast<double>(line), "region " + std::to_string(met[line]));
  panel.y_range = {-0.6, std::max(0.6, static_cast<double>(met.size()) - 0.4)};
  return panel;
}

}  // namespace

ReportFigure regionFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Active region over time";
  result.caption =
      "Which region's law answered each sample, of the regions that were visited. A level line means that "
      "one "
      "affine law flew all along, a jump that the set of active constraints changed, a gap that there was no "
      "answer.";
  // Height of a panel's title and axis [px].
  constexpr double kFrame = 110.0;
  double height = 0.0;
  std::vector<Panel> panels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    panels.push_back(regionPanel(content, axis));
    height = std::max(height, 40.0 + 18.0 * static_cast<double>(panels.back().y_ticks.size()));
  }
  result.figure = pageFigure(std::move(panels), static_cast<int>(height + kFrame));
  return result;
}

namespace {

// The flight's parameters projected on the slice.
Series visitedPoints(const ReportContent& content, std::size_t axis, const Slice& cut) {
  Series points;
  points.color = palette::kInk;
  points.style = Style::kPoints;
  points.width = 2.0;
  const std::size_t stride = content.samples.size() / kDots + 1;
  for (std::size_t index = 0; index < content.samples.size(); index += stride) {
    const ReplaySample& sample = content.samples[index];
    const AxisReport& report = sample.report.axis[axis];
    if (!sample.has_reference || report.size == 0) continue;
    points.x.push_back(report.theta[static_cast<std::size_t>(cut.x)]);
    points.y.push_back(report.theta[static_cast<std::size_t>(cut.y)]);
  }
  return points;
}

// Dark dots on white ones, so that they are seen on every colour.
std::vector<Series> withHalo(const Series& points) {
  Series halo = points;
  halo.color = "#ffffff";
  halo.width = 2.0 * points.width;
  return {halo, points};
}

// The slice around the points, none if they lie outside the map altogether.
std::optional<Slice> sliceNear(const RegionMap& map, SliceRequest request, const Series& points) {
  if (points.x.empty()) return std::nullopt;
  const auto [left, right] = std::minmax_element(points.x.begin(), points.x.end());
  const auto [low, high] = std::minmax_element(points.y.begin(), points.y.end());
  request.x_window = padded(*left, *right, 0.02);
  request.y_window = padded(*low, *high, 0.02);
  const Slice whole = slice(map, {request.x, request.y, request.at});
  const auto apart = [](const Panel::Range& one, const Panel::Range& other) {
    return one.second <= other.first || other.second <= one.first;
  };
  if (apart(*request.x_window, whole.x_range) || apart(*request.y_window, whole.y_range)) return std::nullopt;
  return slice(map, request);
}

}  // namespace

ReportFigure sliceFigure(const ReportContent& content, std::size_t axis) {
  const RegionMap& map = *content.maps[axis];
  const SliceRequest request = flightSlice(content.samples, map, axis);
  const Slice cut = slice(map, request);
  const Series points = visitedPoints(content, axis, cut);
  Panel whole = slicePanel(map, cut);
  whole.title = "Whole map: " + std::to_string(cut.polygons.size()) + " of " +
                std::to_string(map.regionCount()) + " regions are cut";
  if (!points.x.empty()) whole.series = withHalo(points);
  std::vector<Panel> panels = {whole};
  const std::optional<Slice> closer = sliceNear(map, request, points);
  if (closer) {
    panels.push_back(slicePanel(map, *closer));
    panels.back().title = "Where the flight was: " + std::to_string(closer->polygons.size()) +
                          (closer->polygons.size() == 1 ? " region" : " regions");
    panels.back().series = withHalo(points);
  }
  ReportFigure result;
  result.heading = std::string("Partition, ") + kAxisNames[axis].axis + " axis";
  result.caption =
      "A slice of the map through " + axisLabel(map.parameters()[static_cast<std::size_t>(cut.x)]) + " and " +
      axisLabel(map.parameters()[static_cast<std::size_t>(cut.y)]) +
      " with the other parameters at their median of the flight: lines part the regions, colour is the "
      "explicit law's answer, the dark dots are what the flight visited (it also moves off the slice).";
  result.figure = pageFigure(std::move(panels), row_height::kView, 2);
  return result;
}

ReportFigure agreementFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Explicit against online";
  result.caption =
      "Difference between the map's answer and an online QP solved at the same parameters, for every sample; "
      "the ordinate "
      "is logarithmic and equal answers lie on its lower edge.";
  constexpr double kFloor = 1e-17;  // stands for zero on the logarithmic axis
  Panel panel = timePanel("", "|explicit − online| [unit of the input]");
  panel.log_y = true;
  double greatest = 1e-9;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisValidation& used = content.validation.axes[axis];
    Series series;
    series.label = used.input + " [" + used.input_unit + "]";
    series.color = kAxisColors[axis];
    series.style = Style::kPoints;
    for (const auto& [stamp, difference] : used.qp_series) {
      series.x.push_back(stamp - content.samples.front().state.stamp);
      series.y.push_back(std::max(difference, kFloor));
      greatest = std::max(greatest, difference);
    }
    if (!series.x.empty()) panel.series.push_back(thinned(series, kCurvePoints));
  }
  panel.y_range = {kFloor, 10.0 * greatest};
  result.figure = pageFigure({panel}, row_height::kAlone);
  return result;
}

ReportFigure latencyFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Look-up time";
  result.caption =
      "Time of one look-up with its law, measured in batches of 16 on the parameters of this flight: in "
      "their order "
      "(left) and shuffled, so that neither caches nor branch prediction help (right); the last bar also "
      "holds what took longer.";
  std::vector<double> all;
  for (const AxisValidation& axis : content.validation.axes) {
    all.insert(all.end(), axis.lookups.in_order.begin(), axis.lookups.in_order.end());
    all.insert(all.end(), axis.lookups.shuffled.begin(), axis.lookups.shuffled.end());
  }
  // The tail beyond is counted in the last bar.
  const double lower = 0.8 * *std::min_element(all.begin(), all.end());
  const double upper = std::max(1.3 * percentiles(all).p99, lower + 10.0);
  std::vector<Panel> panels;
  for (const bool shuffled : {false, true}) {
    std::vector<double> times;
    for (const AxisValidation& axis : content.validation.axes) {
      const std::vector<double>& part = shuffled ? axis.lookups.shuffled : axis.lookups.in_order;
      times.insert(times.end(), part.begin(), part.end());
    }
    const Percentiles share = percentiles(times);
    Panel panel;
    panel.title = shuffled ? "Shuffled" : "In the order of the flight";
    panel.x_label = "time per look-up [ns]";
    panel.y_label = "batches";
    panel.x_range = {lower, upper};
    panel.series = {histogram(times, lower, upper, 50, false)};
    const std::vector<double>& counts = panel.series[0].y;
    panel.y_range = {0.0, 1.25 * *std::max_element(counts.begin(), counts.end())};  // room for the labels
    panel.marks = {
        {share.p50, "median " + std::to_string(std::lround(share.p50)) + " ns", palette::kInk},
        {share.p99, "99 % below " + std::to_string(std::lround(share.p99)) + " ns", palette::kVermilion}};
    panels.push_back(panel);
  }
  result.figure = pageFigure(std::move(panels), row_height::kAlone, 2);
  return result;
}

}  // namespace polyfly
