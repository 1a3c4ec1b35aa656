#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <iosfwd>
#include <limits>
#include <string>
#include <vector>

#include "map_plot/figure.hpp"
#include "validation/report.hpp"

namespace polyfly {

// What the pictures of a report have in common.

/// Greatest number of points of a curve that is drawn.
constexpr std::size_t kCurvePoints = 1200;
constexpr const char* kAxisColors[3] = {palette::kBlue, palette::kVermilion, palette::kGreen};
/// Value that leaves a gap in a curve.
constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr const char* kMeasuredColor = "#9aa4ae";

/// "name [unit]", or the name alone where there is no unit.
inline std::string withUnit(const std::string& name, const std::string& unit) {
  return unit == "1" || unit.empty() ? name : name + " [" + unit + "]";
}

/// The curve with a gap where neighbouring samples are more than `gap` apart [s].
Series withGaps(Series series, double gap);

/// The curve with a gap wherever samples are missing: where they are farther apart than kGapPeriods of the
/// typical period, at least 0.2 s.
Series withGaps(const Series& series);

/// A curve over the samples, against seconds since the first, with gaps where samples are missing; `value` gives
/// kNothing where there is nothing to draw.
template <class Value>
Series overTime(const ReportContent& content, const std::string& label, const std::string& color,
                Value value) {
  Series series;
  series.label = label;
  series.color = color;
  const double start = content.samples.front().state.stamp;
  for (const ReplaySample& sample : content.samples) {
    series.x.push_back(sample.state.stamp - start);
    series.y.push_back(value(sample));
  }
  return thinned(withGaps(series), kCurvePoints);
}

/// Heights of a row of panels [px].
namespace row_height {
/// Height of each of three or more rows over time.
constexpr int kStacked = 220;
/// Height of each of two rows over time.
constexpr int kPaired = 280;
/// Height of the only row.
constexpr int kAlone = 330;
/// Height of slices, views from above and others that are not over time.
constexpr int kView = 420;
/// Height with equal axes over the whole width.
constexpr int kSquare = 620;
}  // namespace row_height

/// Start from which a figure counts its times: that of the record where times count from 1970, which no axis
/// can show. Otherwise 0 [s].
double figureStart(double first);

/// Lets panels over time count from `start`, which their axis names as a date. Does nothing if it is 0.
void countFrom(double start, std::vector<Panel>* panels);

/// A panel over time, empty.
Panel timePanel(const std::string& title, const std::string& y_label);

/// A picture as wide as the page.
Figure pageFigure(std::vector<Panel> panels, int row_height, int columns = 1);

/// The range of values with a margin of a tenth on each side, at least `least_width` before.
Panel::Range padded(double least, double greatest, double least_width);

ReportFigure regionFigure(const ReportContent& content);
ReportFigure sliceFigure(const ReportContent& content, std::size_t axis);
ReportFigure agreementFigure(const ReportContent& content);
ReportFigure latencyFigure(const ReportContent& content);
ReportFigure heatFigure(const ReportContent& content);
ReportFigure distanceFigure(const ReportContent& content);

/// "optimal 490, clipped 10": the statuses that were met.
std::string answersText(const std::array<std::size_t, kControlStatusCount>& statuses);

/// Sections of the page; nothing where there is nothing to tell.
void writeParameters(const ValidationReport& report, std::ostream& out);
void writeExcursions(const ValidationReport& report, std::ostream& out);
void writeProposals(const ValidationReport& report, std::ostream& out);
void writeComparisons(const ValidationReport& report, std::ostream& out);

}  // namespace polyfly
