#include <algorithm>
#include <cmath>
#include <numeric>

#include "report_parts.hpp"
#include "validation/motion_report.hpp"

namespace polyfly {
namespace {

using Style = Series::Style;

// Greatest number of dots of a scatter plot.
constexpr std::size_t kScatterDots = 3000;
constexpr std::size_t kModelPoints = 80;
constexpr std::size_t kQuantilePoints = 400;

std::vector<double> residualOf(const MotionTrace& trace) {
  std::vector<double> residual(trace.measured.size());
  std::transform(trace.measured.begin(), trace.measured.end(), trace.modelled.begin(), residual.begin(),
                 std::minus<>());
  return residual;
}

// A curve over time with a gap between stretches.
Series curve(const MotionTrace& trace, const std::vector<double>& value, const std::string& label,
             const std::string& color) {
  Series series;
  series.label = label;
  series.color = color;
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (i > 0 && std::find(trace.starts.begin(), trace.starts.end(), i) != trace.starts.end()) {
      series.x.push_back(trace.time[i]);
      series.y.push_back(kNothing);
    }
    series.x.push_back(trace.time[i]);
    series.y.push_back(value[i]);
  }
  return thinned(series, 2 * kCurvePoints);
}

// What was used of the flight: the whole record of velocities, with the stretches shaded.
ReportFigure selectionFigure(const MotionCalibration& calibration) {
  ReportFigure result;
  result.heading = "What was used";
  result.caption =
      "All velocities that the log holds in flight; shaded: the stretches that the numbers come from.";
  Panel panel = timePanel("", "velocity [m/s]");
  const MotionTrace& trace = calibration.fit.traces.front();
  for (std::size_t i = 0; i + 1 < trace.starts.size(); ++i) {
    if (trace.starts[i + 1] > trace.starts[i])
      panel.bands.push_back({trace.time[trace.starts[i]], trace.time[trace.starts[i + 1] - 1]});
  }
  for (std::size_t i = 0; i < calibration.record.size(); ++i) {
    Series series;
    series.x = calibration.record[i].second.time;
    series.y = calibration.record[i].second.value;
    series.label = calibration.record[i].first;
    series.color = kAxisColors[i % 3];
    panel.series.push_back(thinned(withGaps(series), kCurvePoints));
  }
  std::vector<Panel> panels = {panel};
  if (!trace.time.empty()) countFrom(figureStart(trace.time.front()), &panels);
  result.figure = pageFigure(std::move(panels), row_height::kAlone);
  return result;
}

ReportFigure timeFigure(const MotionTrace& trace, const DisturbanceBound* bound) {
  ReportFigure result;
  result.heading = trace.name + ": measured and modelled";
  result.caption =
      bound != nullptr
          ? "Above, what was measured and what thrust, attitude, gravity and drag explain; below, "
            "what is left, which is the disturbance, with its bounds."
          : "On the data that the model was made from; below, what it leaves.";
  Panel panel = timePanel("", withUnit("measured, modelled", trace.unit));
  Series measured = curve(trace, trace.measured, "measured", kMeasuredColor);
  measured.width = 3.0;
  panel.series = {measured, curve(trace, trace.modelled, "modelled", palette::kBlue)};
  Panel left = timePanel("", withUnit("measured − modelled", trace.unit));
  left.series = {curve(trace, residualOf(trace), "", palette::kBlue)};
  if (bound != nullptr) left.bounds = {{bound->least, "bound"}, {bound->greatest, "bound"}};
  std::vector<Panel> panels = {panel, left};
  if (!trace.time.empty()) countFrom(figureStart(trace.time.front()), &panels);
  result.figure = pageFigure(std::move(panels), row_height::kPaired);
  return result;
}

// Quantiles of the residual.
Panel quantilePanel(const MotionTrace& trace, const DisturbanceBound* bound) {
  std::vector<double> sorted = residualOf(trace);
  std::sort(sorted.begin(), sorted.end());
  Panel panel;
  panel.x_label = "share of the time below [%]";
  panel.y_label = withUnit("measured − modelled", trace.unit);
  Series series;
  series.style = Style::kLine;
  series.color = palette::kBlue;
  const std::size_t points = std::min(kQuantilePoints, sorted.size());
  for (std::size_t i = 0; i < points; ++i) {
    const double share = points > 1 ? static_cast<double>(i) / static_cast<double>(points - 1) : 0.5;
    series.x.push_back(100.0 * share);
    series.y.push_back(sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))]);
  }
  panel.series = {series};
  if (bound != nullptr) panel.bounds = {{bound->least, "bound"}, {bound->greatest, "bound"}};
  return panel;
}

Panel scatterPanel(const MotionTrace& trace) {
  Panel panel;
  panel.legend_below = true;
  panel.x_label = trace.against;
  panel.y_label = withUnit("measured, modelled", trace.unit);
  Series dots;
  dots.style = Style::kPoints;
  dots.label = "measured";
  dots.color = kMeasuredColor;
  dots.width = 3.0;
  Series line;
  line.label = "model";
  line.color = palette::kVermilion;
  const std::size_t stride = trace.depends.size() / kScatterDots + 1;
  for (std::size_t i = 0; i < trace.depends.size(); i += stride) {
    dots.x.push_back(trace.depends[i]);
    dots.y.push_back(trace.measured[i]);
  }
  // Every model here is a function of what it depends on.
  std::vector<std::size_t> order(trace.depends.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&trace](std::size_t one, std::size_t other) {
    return trace.depends[one] < trace.depends[other];
  });
  for (std::size_t i = 0; i < kModelPoints && !order.empty(); ++i) {
    const std::size_t place = order[i * (order.size() - 1) / (kModelPoints - 1)];
    line.x.push_back(trace.depends[place]);
    line.y.push_back(trace.modelled[place]);
  }
  panel.series = {dots, line};
  return panel;
}

ReportFigure distributionFigure(const MotionTrace& trace, const DisturbanceBound* bound) {
  ReportFigure result;
  result.heading = trace.name + ": distribution";
  result.caption =
      trace.against.empty()
          ? "Quantiles: how much of the time the disturbance lies below a value."
          : "Left, quantiles: how much of the time the residual lies below a value; right, each sample and "
            "the model against what it depends on.";
  std::vector<Panel> panels = {quantilePanel(trace, bound)};
  if (!trace.against.empty()) panels.push_back(scatterPanel(trace));
  const auto columns = static_cast<int>(panels.size());
  result.figure = pageFigure(std::move(panels), row_height::kView, columns);
  return result;
}

}  // namespace

std::vector<ReportFigure> motionFigures(const MotionCalibration& calibration) {
  std::vector<ReportFigure> figures;
  if (calibration.fit.traces.empty()) return figures;
  if (!calibration.record.empty()) figures.push_back(selectionFigure(calibration));
  for (std::size_t i = 0; i < calibration.fit.traces.size(); ++i) {
    const DisturbanceBound* bound = i < calibration.bounds.size() ? &calibration.bounds[i] : nullptr;
    figures.push_back(timeFigure(calibration.fit.traces[i], bound));
    figures.push_back(distributionFigure(calibration.fit.traces[i], bound));
  }
  return figures;
}

}  // namespace polyfly
