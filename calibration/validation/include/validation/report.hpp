#pragma once

#include <string>
#include <vector>

#include "validation/flight_log.hpp"
#include "validation/replay.hpp"
#include "validation/validation.hpp"

namespace polyfly {

/// The content of a report. References: they must stay valid until the report is written.
struct ReportContent {
  const FlightLog& log;
  const std::vector<ReplaySample>& samples;
  const AxisMaps& maps;
  const MultirotorOptions& options;
  const ValidationReport& validation;
};

/// The whole page.
Report reportOn(const ReportContent& content);

/// Name of the file that writeReport writes for an axis: time and parameters of each sample, as `offline_mpt explore` reads them.
std::string samplesFile(std::size_t axis);

/// Writes `index.html`, `summary.json` and the samples of each axis into the folder, which is made where it is missing.
/// Throws Error naming the file.
void writeReport(const ReportContent& content, const std::string& folder);

/// The page of several flights, with `summary.json` of all together. Their own pages are expected in
/// `flight_1`, `flight_2` and so on of the same folder. `flights` must not be empty. Throws Error.
void writeOverview(const std::vector<ValidationReport>& flights, const ValidationReport& all,
                   const std::string& folder);

}  // namespace polyfly
