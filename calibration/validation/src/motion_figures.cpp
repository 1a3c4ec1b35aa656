#include <algorithm>
#include <functional>

#include "report_parts.hpp"
#include "validation/motion_report.hpp"

namespace polyfly {
namespace {

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

}  // namespace

std::vector<ReportFigure> motionFigures(const MotionCalibration& calibration) {
  std::vector<ReportFigure> figures;
  if (calibration.fit.traces.empty()) return figures;
  if (!calibration.record.empty()) figures.push_back(selectionFigure(calibration));
  for (std::size_t i = 0; i < calibration.fit.traces.size(); ++i) {
    const DisturbanceBound* bound = i < calibration.bounds.size() ? &calibration.bounds[i] : nullptr;
    figures.push_back(timeFigure(calibration.fit.traces[i], bound));
  }
  return figures;
}

}  // namespace polyfly
