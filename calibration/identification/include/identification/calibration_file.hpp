#pragma once

#include <string>
#include <utility>
#include <vector>

#include "identification/loop_record.hpp"
#include "identification/vehicle_kind.hpp"
#include "polyfly_base/provenance.hpp"
#include "report/report.hpp"

namespace polyfly {

/// Version of the identification, written into every result; raised when the same data give other numbers.
constexpr const char* kIdentificationVersion = "5";

/// The flights of a calibration, one or several of one vehicle.
struct CalibrationFlights {
  std::vector<Provenance> data;
  VehicleKind vehicle;
  /// True: parts of a flight's record are lost. The remarks say which.
  bool lossy = false;
  /// Sentences on what was wrong with the files.
  std::vector<std::string> remarks;
};

/// The first keys of a calibration file; `data` are those of the flights, and maybe more.
Json calibrationHead(const std::string& kind, const CalibrationFlights& flights, const Json& data);

/// One flight as a map, several as a list.
Json jsonOf(const std::vector<Provenance>& flights);

/// As [[from, to], ...].
Json jsonOf(const std::vector<TimeWindow>& windows);

/// A calibration's page without its sections. It is green where the flights' remarks and the reasons are none.
Report calibrationPage(const CalibrationFlights& flights, const std::vector<std::string>& reasons);

/// What is printed, before the numbers.
std::string notesOn(const CalibrationFlights& flights);

/// A curve in the colour, with gaps where samples are missing.
Series curveOf(const TimeSeries& series, const std::string& label, const std::string& color);

/// The curves of a whole record, with what was used shaded. Times count from `first` where they count from 1970.
ReportSection selectionSection(const std::string& heading, const std::string& caption, Panel panel,
                               double first);

/// Models beside what was measured.
struct Comparison {
  std::string name;
  std::string unit;
  TimeSeries measured;
  /// Title and values of each model, at the times of what was measured.
  std::vector<std::pair<std::string, std::vector<double>>> models;
  /// Bounds of what is left.
  std::vector<Rule> bounds;
};

/// What was measured with the models, and what these leave, below.
ReportSection comparisonSection(const std::string& heading, const std::string& caption, const Comparison& one,
                                double first);

}  // namespace polyfly
