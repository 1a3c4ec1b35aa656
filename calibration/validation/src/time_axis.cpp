#include <algorithm>
#include <cmath>
#include <utility>

#include "bags/scan_bag.hpp"
#include "identification/loop_record.hpp"
#include "report_parts.hpp"

namespace polyfly {
namespace {

// Least pause that is drawn as a gap [s].
constexpr double kLeastDrawnGap = 0.2;

}  // namespace

Series withGaps(Series series, double gap) {
  std::vector<double> x;
  std::vector<double> y;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    if (i > 0 && series.x[i] - series.x[i - 1] > gap) {
      x.push_back(0.5 * (series.x[i] + series.x[i - 1]));
      y.push_back(kNothing);
    }
    x.push_back(series.x[i]);
    y.push_back(series.y[i]);
  }
  series.x = std::move(x);
  series.y = std::move(y);
  return series;
}

Series withGaps(const Series& series) {
  const double period = typicalPeriod({series.x, series.y}, kLongestPeriod);
  // Of samples that are all far apart a line is all that can be drawn.
  if (period <= 0.0) return series;
  return withGaps(series, std::max(kLeastDrawnGap, kGapPeriods * period));
}

double figureStart(double first) { return countsFromEpoch(first) ? std::floor(first) : 0.0; }

void countFrom(double start, std::vector<Panel>* panels) {
  if (start == 0.0) return;
  for (Panel& panel : *panels) {
    panel.x_label = "time since " + isoTime(start) + " [s]";
    for (Series& series : panel.series) {
      for (double& x : series.x) x -= start;
    }
    for (Band& band : panel.bands) {
      band.from -= start;
      band.to -= start;
    }
    for (Rule& mark : panel.marks) mark.value -= start;
  }
}

}  // namespace polyfly
