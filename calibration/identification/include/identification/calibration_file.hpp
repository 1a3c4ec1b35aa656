#pragma once

#include <string>
#include <vector>

#include "identification/loop_record.hpp"
#include "identification/vehicle_kind.hpp"
#include "polyfly_base/provenance.hpp"
#include "report/report.hpp"

namespace polyfly {

/// Version of the identification, written into every result; raised when the same data give other numbers.
constexpr const char* kIdentificationVersion = "4";

/// The first keys of a calibration file; those of `data` may be more.
Json calibrationHead(const std::string& kind, const Json& data, const VehicleKind& vehicle);

/// One flight as a map, several as a list.
Json jsonOf(const std::vector<Provenance>& flights);

/// As [[from, to], ...].
Json jsonOf(const std::vector<TimeWindow>& windows);

/// A calibration's page without its sections. It is green where nothing speaks against the numbers.
Report calibrationPage(const std::vector<Provenance>& flights, const std::vector<std::string>& reasons);

}  // namespace polyfly
