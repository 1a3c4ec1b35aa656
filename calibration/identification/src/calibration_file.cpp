#include "identification/calibration_file.hpp"

#include <iterator>

#include "report/figures.hpp"

namespace polyfly {
namespace {

constexpr double kMeasuredWidth = 3.5;  // [px]
constexpr const char* kModelColors[] = {palette::kBlue, palette::kVermilion, palette::kGreen,
                                        palette::kPurple};

}  // namespace

Json calibrationHead(const std::string& kind, const CalibrationFlights& flights, const Json& data) {
  return {{"polyfly_calibration", 1},
          {"kind", kind},
          {"tool_version", kIdentificationVersion},
          {"data", data},
          {"vehicle", {{"kind", flights.vehicle.name}, {"reason", flights.vehicle.reason}}},
          {"remarks", flights.remarks}};
}

Json jsonOf(const std::vector<Provenance>& flights) {
  Json list = Json::array();
  for (const Provenance& flight : flights)
    list.push_back({{"file", flight.file}, {"checksum", flight.checksum}, {"recorded", flight.recorded}});
  return list.size() == 1 ? list.front() : list;
}

Json jsonOf(const std::vector<TimeWindow>& windows) {
  Json list = Json::array();
  for (const TimeWindow& window : windows) list.push_back({window.from, window.to});
  return list;
}

Report calibrationPage(const CalibrationFlights& flights, const std::vector<std::string>& reasons) {
  Report page;
  page.title = "Calibration report";
  for (const Provenance& flight : flights.data)
    page.sources.push_back(flight.file + " · " + flight.checksum +
                           (flight.recorded.empty() ? "" : " · " + flight.recorded));
  page.reasons = flights.remarks;
  page.reasons.insert(page.reasons.end(), reasons.begin(), reasons.end());
  page.good = page.reasons.empty();
  page.verdict =
      page.good ? "The data support these numbers" : "To be looked at before these numbers are used";
  return page;
}

std::string notesOn(const CalibrationFlights& flights) {
  std::string notes;
  for (const std::string& remark : flights.remarks) notes += "note: " + remark + "\n";
  return notes;
}

Series curveOf(const TimeSeries& series, const std::string& label, const std::string& color) {
  Series curve;
  curve.label = label;
  curve.x = series.time;
  curve.y = series.value;
  curve.color = color;
  return thinned(withGaps(std::move(curve)), kCurvePoints);
}

ReportSection selectionSection(const std::string& heading, const std::string& caption, Panel panel,
                               double first) {
  std::vector<Panel> panels = {std::move(panel)};
  countFrom(first, &panels);
  return pictured(heading, caption, panels, row_height::kAlone);
}

ReportSection comparisonSection(const std::string& heading, const std::string& caption, const Comparison& one,
                                double first) {
  Panel panel = timePanel("", withUnit(one.name, one.unit));
  Panel left = timePanel("", withUnit("measured − model", one.unit));
  panel.series = {curveOf(one.measured, "measured", kMeasuredColor)};
  panel.series.front().width = kMeasuredWidth;
  for (std::size_t i = 0; i < one.models.size(); ++i) {
    const auto& [title, values] = one.models[i];
    const char* color = kModelColors[i % std::size(kModelColors)];
    panel.series.push_back(curveOf({one.measured.time, values}, title, color));
    TimeSeries residual = one.measured;
    for (std::size_t k = 0; k < values.size(); ++k) residual.value[k] -= values[k];
    left.series.push_back(curveOf(residual, title, color));
  }
  left.bounds = one.bounds;
  std::vector<Panel> panels = {panel, left};
  countFrom(first, &panels);
  return pictured(heading, caption, panels, row_height::kPaired);
}

}  // namespace polyfly
