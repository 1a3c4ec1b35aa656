#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "map_plot/slice.hpp"
#include "online_controller/laws/axis.hpp"
#include "report_parts.hpp"

namespace polyfly {
namespace {

// Columns of the grid in which samples are counted.
constexpr int kColumns = 48;
// Rows of the grid in which samples are counted.
constexpr int kRows = 32;

// From few samples to many, each twice the one before or more.
constexpr const char* kHeat[6] = {"#fde725", "#7ad151", "#22a884", "#2a788e", "#414487", "#440154"};

using Cell = std::pair<int, int>;

// Samples of the flight in each cell of the grid over two parameters.
std::map<Cell, double> countCells(const ReportContent& content, std::size_t axis, const Slice& cut) {
  std::map<Cell, double> counts;
  const auto place = [](double value, const Panel::Range& range, int cells) {
    return static_cast<int>(std::floor((value - range.first) / (range.second - range.first) * cells));
  };
  for (const ReplaySample& sample : content.samples) {
    const AxisReport& report = sample.report.axis[axis];
    if (!sample.has_reference || report.size == 0) continue;
    const int column = place(report.theta[static_cast<std::size_t>(cut.x)], cut.x_range, kColumns);
    const int row = place(report.theta[static_cast<std::size_t>(cut.y)], cut.y_range, kRows);
    if (column >= 0 && column < kColumns && row >= 0 && row < kRows) ++counts[{column, row}];
  }
  return counts;
}

std::vector<std::pair<double, double>> corners(const Cell& cell, const Slice& cut) {
  const double width = (cut.x_range.second - cut.x_range.first) / kColumns;
  const double height = (cut.y_range.second - cut.y_range.first) / kRows;
  const double x = cut.x_range.first + width * cell.first;
  const double y = cut.y_range.first + height * cell.second;
  return {{x, y}, {x + width, y}, {x + width, y + height}, {x, y + height}};
}

// Cells coloured by the logarithm of their samples, with the regions' outlines above.
Panel heatPanel(const ReportContent& content, std::size_t axis, const Slice& cut) {
  constexpr int kLevels = static_cast<int>(std::size(kHeat));
  const std::map<Cell, double> counts = countCells(content, axis, cut);
  double most = 1.0;
  for (const auto& [cell, count] : counts) most = std::max(most, count);
  const double per_level = std::max(std::log(2.0), std::log(most) / kLevels);
  std::vector<Patches> levels(kLevels);
  for (std::size_t level = 0; level < levels.size(); ++level) levels[level].fill = kHeat[level];
  for (const auto& [cell, count] : counts) {
    const int level = std::min(kLevels - 1, static_cast<int>(std::log(count) / per_level));
    levels[static_cast<std::size_t>(level)].polygons.push_back(corners(cell, cut));
  }
  Panel panel = slicePanel(*content.maps[axis], cut);
  Patches outlines;
  outlines.border = palette::kGrey;
  for (const SlicePolygon& polygon : cut.polygons) outlines.polygons.push_back(polygon.corners);
  panel.patches.clear();
  for (Patches& level : levels) {
    if (!level.polygons.empty()) panel.patches.push_back(std::move(level));
  }
  panel.patches.push_back(outlines);
  ColorScale scale;
  scale.lower = 0.0;
  scale.upper = kLevels * per_level / std::log(10.0);
  scale.label = "samples in a cell, log 10";
  scale.colors.assign(std::begin(kHeat), std::end(kHeat));
  panel.scale = scale;
  return panel;
}

// What was met of a parameter, with a margin; none where that lies outside the map.
std::optional<Panel::Range> visitedRange(const MapUse& use, const std::string& name) {
  // Least width of the drawn range, in ranges of the parameter.
  constexpr double kLeastWidth = 1e-3;
  for (const ParameterUse& parameter : use.parameters) {
    if (parameter.name != name) continue;
    if (!(parameter.least < parameter.upper && parameter.greatest > parameter.lower)) return std::nullopt;
    return padded(parameter.least, parameter.greatest, kLeastWidth * (parameter.upper - parameter.lower));
  }
  return std::nullopt;
}

}  // namespace

ReportFigure heatFigure(const ReportContent& content) {
  ReportFigure result;
  result.heading = "Where the flight spent its time";
  result.caption =
      "Samples in each cell of a grid over position and velocity error, whatever the other parameters; the "
      "lines are the regions that a slice at the other parameters' middle cuts. Regions without colour were "
      "never tried.";
  std::vector<Panel> panels;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    SliceRequest request;
    request.x = kAxisNames[axis].position_error;
    request.y = kAxisNames[axis].velocity_error;
    panels.push_back(heatPanel(content, axis, slice(*content.maps[axis], request)));
    panels.back().title = std::string(kAxisNames[axis].axis) + ", whole range";
    request.x_window = visitedRange(content.validation.axes[axis], request.x);
    request.y_window = visitedRange(content.validation.axes[axis], request.y);
    if (!request.x_window || !request.y_window) continue;
    panels.push_back(heatPanel(content, axis, slice(*content.maps[axis], request)));
    panels.back().title = std::string(kAxisNames[axis].axis) + ", where the flight was";
  }
  result.figure = pageFigure(std::move(panels), row_height::kView, 2);
  return result;
}

ReportFigure distanceFigure(const ReportContent& content) {
  // Lower end of the logarithmic axis.
  constexpr double kFloor = 1e-4;
  ReportFigure result;
  result.heading = "Distance to the map's edge";
  result.caption =
      "How far the parameters could still have moved, along the one that is nearest to it, before the map "
      "ended (coloured), and how far the nearest face of the region was (grey); ranges are scaled to -1 .. "
      "1. "
      "Shaded: outside the map.";
  std::vector<Panel> panels;
  const double start = content.samples.front().state.stamp;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const AxisValidation& used = content.validation.axes[axis];
    if (used.edge_series.empty()) continue;
    Series face;
    face.label = "nearest face";
    face.color = palette::kGrey;
    Series edge;
    edge.label = "edge of the map";
    edge.color = kAxisColors[axis];
    const auto add = [&](double time, double to_face, double to_edge) {
      face.x.push_back(time - start);
      face.y.push_back(to_face);
      edge.x.push_back(time - start);
      edge.y.push_back(to_edge);
    };
    auto left = used.excursions.begin();
    for (const auto& [stamp, to_face, to_edge] : used.edge_series) {
      for (; left != used.excursions.end() && left->from < stamp; ++left) add(left->from, kNothing, kNothing);
      const auto drawn = [&](double distance) {
        return std::isfinite(distance) ? std::max(distance, kFloor) : kNothing;
      };
      add(stamp, drawn(to_face), drawn(to_edge));
    }
    Panel panel = timePanel(used.axis, "distance [-]");
    panel.log_y = true;
    panel.y_range = {kFloor, 2.0};
    for (const Excursion& excursion : used.excursions) {
      panel.bands.push_back({excursion.from - start, excursion.to - start});
    }
    panel.series = {thinned(face, kCurvePoints), thinned(edge, kCurvePoints)};
    panels.push_back(panel);
  }
  result.figure = pageFigure(std::move(panels), row_height::kStacked);
  return result;
}

}  // namespace polyfly
