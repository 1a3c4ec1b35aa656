#pragma once

#include <vector>

#include "report/figures.hpp"
#include "validation/report.hpp"

namespace polyfly {

/// The pictures of a flight, in the order of the page; what the log does not hold is left out.
std::vector<ReportSection> flightFigures(const ReportContent& content);

/// Those of the maps: where their regions lie and where the flight was.
std::vector<ReportSection> mapFigures(const ReportContent& content);

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

}  // namespace polyfly
