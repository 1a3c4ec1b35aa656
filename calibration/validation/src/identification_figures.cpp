#include <algorithm>
#include <cmath>
#include <iterator>

#include "report_parts.hpp"
#include "validation/identification_report.hpp"

namespace polyfly {
namespace {

using Style = Series::Style;

constexpr const char* kRejectedColor = "#f6dcd3";
// Of the models for a controller, in their order.
constexpr const char* kModelColors[] = {palette::kBlue, palette::kVermilion, palette::kGreen,
                                        palette::kPurple};

// First time of the record, from which figures of a record since 1970 count [s].
double startOf(const AxisModel& axis) {
  return figureStart(std::min(axis.record.response.time.front(), axis.record.command.time.front()));
}

// Curves of all segments with a gap between them.
Series ofSegments(const std::vector<LoopSegment>& segments, const std::string& label,
                  const std::string& color) {
  Series series;
  series.label = label;
  series.color = color;
  for (const LoopSegment& segment : segments) {
    if (!series.x.empty()) {
      series.x.push_back(segment.time.front());
      series.y.push_back(kNothing);
    }
    series.x.insert(series.x.end(), segment.time.begin(), segment.time.end());
    series.y.insert(series.y.end(), segment.response.begin(), segment.response.end());
  }
  return series;
}

Series ofPrediction(const std::vector<LoopSegment>& segments,
                    const std::vector<std::vector<double>>& prediction, const std::string& label,
                    const std::string& color) {
  std::vector<LoopSegment> predicted;
  for (std::size_t i = 0; i < segments.size(); ++i) {
    predicted.push_back({segments[i].time, prediction[i], {}, 0.0});
  }
  return ofSegments(predicted, label, color);
}

ReportFigure selectionFigure(const AxisModel& axis) {
  ReportFigure result;
  const double start = startOf(axis);
  result.heading = axis.axis + ": what was used";
  result.caption =
      "The whole record; shaded yellow: used; shaded red: left out, for the reasons listed above.";
  Panel panel = timePanel("", withUnit(axis.axis, axis.unit));
  for (const TimeWindow& window : axis.choice.windows) panel.bands.push_back({window.from, window.to});
  for (const RejectedWindow& rejected : axis.choice.rejected) {
    panel.bands.push_back({rejected.window.from, rejected.window.to, kRejectedColor});
  }
  Series response;
  response.x = axis.record.response.time;
  response.y = axis.record.response.value;
  response.label = "measured";
  response.color = kMeasuredColor;
  panel.series = {thinned(withGaps(response), kCurvePoints)};
  if (axis.command_unit == axis.unit) {
    Series command;
    command.x = axis.record.command.time;
    command.y = axis.record.command.value;
    command.label = "command";
    command.color = palette::kVermilion;
    command.style = Style::kSteps;
    panel.series.push_back(thinned(withGaps(command), kCurvePoints));
  }
  std::vector<Panel> panels = {panel};
  countFrom(start, &panels);
  result.figure = pageFigure(std::move(panels), row_height::kAlone);
  return result;
}

ReportFigure comparisonFigure(
    const std::string& heading, const std::string& caption, const AxisModel& axis,
    const std::vector<LoopSegment>& segments,
    const std::vector<std::pair<std::string, const std::vector<std::vector<double>>*>>& models) {
  const auto color_of = [](std::size_t i) { return kModelColors[i % std::size(kModelColors)]; };
  ReportFigure result;
  result.heading = heading;
  result.caption = caption;
  Panel panel = timePanel("", withUnit(axis.axis, axis.unit));
  Panel residuals = timePanel("", withUnit("measured − model", axis.unit));
  Series measured = ofSegments(segments, "measured", kMeasuredColor);
  measured.width = 3.5;
  panel.series = {thinned(measured, 2 * kCurvePoints)};
  for (std::size_t i = 0; i < models.size(); ++i) {
    const Series model = ofPrediction(segments, *models[i].second, models[i].first, color_of(i));
    Series residual = model;
    for (std::size_t k = 0; k < residual.y.size(); ++k) residual.y[k] = measured.y[k] - model.y[k];
    panel.series.push_back(thinned(model, 2 * kCurvePoints));
    residuals.series.push_back(thinned(residual, 2 * kCurvePoints));
  }
  std::vector<Panel> panels = {panel, residuals};
  // Another flight has a clock of its own.
  const bool own = segments.empty() || segments.front().time.front() >= axis.record.response.time.front();
  countFrom(own ? startOf(axis) : figureStart(segments.front().time.front()), &panels);
  result.figure = pageFigure(std::move(panels), row_height::kPaired);
  return result;
}

}  // namespace

std::vector<ReportFigure> identificationFigures(const AxisModel& axis) {
  std::vector<ReportFigure> figures;
  figures.push_back(selectionFigure(axis));
  std::vector<std::pair<std::string, const std::vector<std::vector<double>>*>> models;
  std::vector<std::pair<std::string, const std::vector<std::vector<double>>*>> validated;
  for (const ControllerModel& model : axis.controller_models) {
    models.emplace_back(model.title, &model.fit.prediction);
    if (model.validation) validated.emplace_back(model.title, &model.validation->prediction);
  }
  figures.push_back(comparisonFigure(axis.axis + ": measured and modelled",
                                     "On the data that the models were made from; below, what they leave.",
                                     axis, axis.segments, models));
  if (axis.validation) {
    figures.push_back(comparisonFigure(
        axis.axis + ": validation",
        axis.validation->by_halves
            ? "The models of the first half of the data on the second half, which they have not seen."
            : "The models on " + axis.validation->source + ", which they have not seen.",
        axis, axis.validation->segments, validated));
  }
  return figures;
}

}  // namespace polyfly
