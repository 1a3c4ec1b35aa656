#pragma once

#include <vector>

#include "report/figures.hpp"
#include "validation/report.hpp"

namespace polyfly {

/// The pictures of a flight, in the order of the page; what the log does not hold is left out.
std::vector<ReportSection> flightFigures(const ReportContent& content);

}  // namespace polyfly
