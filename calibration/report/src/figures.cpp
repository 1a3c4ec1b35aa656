#include "report/figures.hpp"

#include <cmath>
#include <utility>

#include "bags/scan_bag.hpp"
#include "polyfly_base/quantile.hpp"

namespace polyfly {
namespace {

// Width of the page's text [px].
constexpr int kFigureWidth = 1040;
// Least pause that is drawn as a gap [s], and periods of the curve that are one.
constexpr double kLeastDrawnGap = 0.2;
constexpr double kDrawnGapPeriods = 6.0;
// Samples that are farther apart tell no period [s].
constexpr double kLongestDrawnPeriod = 2.0;

// Pause from which on a curve is interrupted; infinite where all samples are far apart [s].
double drawnGap(const std::vector<double>& time) {
  std::vector<double> periods;
  for (std::size_t i = 1; i < time.size(); ++i) {
    if (time[i] - time[i - 1] <= kLongestDrawnPeriod) periods.push_back(time[i] - time[i - 1]);
  }
  if (periods.empty()) return std::numeric_limits<double>::infinity();
  return std::max(kLeastDrawnGap, kDrawnGapPeriods * quantileOf(std::move(periods)));
}

}  // namespace

Series withGaps(Series series) {
  const double gap = drawnGap(series.x);
  const std::vector<double> x = std::exchange(series.x, {}), y = std::exchange(series.y, {});
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (i > 0 && x[i] - x[i - 1] > gap) {
      series.x.push_back(0.5 * (x[i] + x[i - 1]));
      series.y.push_back(kNothing);
    }
    series.x.push_back(x[i]);
    series.y.push_back(y[i]);
  }
  return series;
}

void countFrom(double first, std::vector<Panel>* panels) {
  if (!countsFromEpoch(first)) return;
  const double start = std::floor(first);
  for (Panel& panel : *panels) {
    panel.x_label = "time since " + isoTime(start) + " [s]";
    for (Series& series : panel.series) {
      for (double& x : series.x) x -= start;
    }
    for (Band& band : panel.bands) {
      band.from -= start;
      band.to -= start;
    }
  }
}

Panel timePanel(const std::string& title, const std::string& y_label) {
  Panel panel;
  panel.title = title;
  panel.x_label = "time [s]";
  panel.y_label = y_label;
  return panel;
}

ReportSection pictured(const std::string& heading, const std::string& caption, std::vector<Panel> panels,
                       int row_height, int columns) {
  Figure figure;
  const auto count = static_cast<int>(panels.size());
  figure.panels = std::move(panels);
  figure.columns = columns;
  figure.width = kFigureWidth;
  figure.height = row_height * std::max(1, (count + columns - 1) / columns);
  return {heading, {caption}, {}, std::nullopt, figure};
}

Panel::Range padded(double least, double greatest, double least_width) {
  const double width = std::max(greatest - least, least_width);
  const double middle = 0.5 * (least + greatest);
  return {middle - 0.6 * width, middle + 0.6 * width};
}

}  // namespace polyfly
