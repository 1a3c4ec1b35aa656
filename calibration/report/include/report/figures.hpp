#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <vector>

#include "report/report.hpp"

namespace polyfly {

// What the pictures of the reports have in common.

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

/// The curve with a gap wherever samples are missing: where they are farther apart than some typical periods, at
/// least 0.2 s.
Series withGaps(Series series);

/// A curve over the items of a list, thinned, with gaps. `point` gives the time [s] and the value of an item; times are drawn
/// from `start` on.
template <class List, class Point>
Series curve(const std::string& label, const std::string& color, double start, const List& list,
             Point point) {
  Series series;
  series.label = label;
  series.color = color;
  for (const auto& item : list) {
    const auto [time, value] = point(item);
    series.x.push_back(time - start);
    series.y.push_back(value);
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
}  // namespace row_height

/// Lets panels over time count from the whole second before `first` where times count from 1970, which no axis can
/// show. The axis names the date.
void countFrom(double first, std::vector<Panel>* panels);

/// A panel over time, empty.
Panel timePanel(const std::string& title, const std::string& y_label);

/// A section with a picture as wide as the page.
ReportSection pictured(const std::string& heading, const std::string& caption, std::vector<Panel> panels,
                       int row_height, int columns = 1);

/// The range of values with a margin of a tenth on each side, at least `least_width` before.
Panel::Range padded(double least, double greatest, double least_width);

}  // namespace polyfly
