#pragma once

#include <array>
#include <string>
#include <vector>

#include "validation/replay.hpp"
#include "validation/report.hpp"

namespace polyfly {

/// Names of the pages that writeFlightPages writes, in the order of the axes.
std::array<std::string, 3> flightPageNames();

/// Writes one page per axis into the folder, which is made where it is missing. A browser explores the axis' map
/// there (region_maps/region_maps/explorer), with the flight's samples. Samples without parameters are left out. Times count from
/// the first sample. `source` names the flight. Throws Error.
void writeFlightPages(const std::vector<ReplaySample>& samples, const AxisMaps& maps,
                      const std::string& source, const std::string& folder);

/// Links from a page in `report_folder` to the pages in `folder`.
std::vector<ReportLink> flightPageLinks(const AxisMaps& maps, const std::string& folder,
                                        const std::string& report_folder);

}  // namespace polyfly
