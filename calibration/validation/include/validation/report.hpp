#pragma once

#include <string>
#include <vector>

#include "map_plot/figure.hpp"
#include "validation/flight_log.hpp"
#include "validation/replay.hpp"
#include "validation/validation.hpp"

namespace polyfly {

/// A link to a page beside the report.
struct ReportLink {
  std::string text;
  /// Relative to the report, escaped as in a URL.
  std::string address;
};

/// The content of a report. References: they must stay valid until the report is written.
struct ReportContent {
  const FlightLog& log;
  const std::vector<ReplaySample>& samples;
  const AxisMaps& maps;
  const MultirotorOptions& options;
  const ValidationReport& validation;
  /// Pages that show the maps with this flight.
  std::vector<ReportLink> map_pages = {};
};

/// A picture with the sentence under it.
struct ReportFigure {
  std::string heading;
  std::string caption;
  Figure figure;
};

/// The pictures of a flight, in the order of the page; what the log does not hold is left out.
std::vector<ReportFigure> reportFigures(const ReportContent& content);

/// The page as one HTML text with its pictures inside. Runs gnuplot. Throws Error.
std::string toHtml(const ReportContent& content);

/// Writes `index.html` and `summary.json` into the folder, which is made where it is missing. Throws Error
/// naming the file.
void writeReport(const ReportContent& content, const std::string& folder);

/// The page of several flights, with `summary.json` of all together. Their own pages are expected in
/// `flight_1`, `flight_2` and so on of the same folder. `flights` must not be empty. Throws Error.
void writeOverview(const std::vector<ValidationReport>& flights, const ValidationReport& all,
                   const std::string& folder);

}  // namespace polyfly
