#pragma once

#include <cstddef>
#include <vector>

#include "difference_collector.hpp"
#include "validation/validation.hpp"

namespace polyfly {

// The parts of a validation.

/// One axis' map against the samples: its use, excursions, agreement with the online solver, look-up times.
AxisValidation validateAxis(const FlightLog& log, const std::vector<ReplaySample>& samples,
                            const RegionMap& map, std::size_t index, const OracleMaker& maker);

/// Recorded commands against the replay's and against the bounds of the options.
CommandValidation validateCommands(const FlightLog& log, const std::vector<ReplaySample>& samples,
                                   const MultirotorOptions& options);

/// What the record lacks, in sentences: parts of it, stamps, commands of the flight, odometry of commands.
std::vector<std::string> recordWarnings(const FlightLog& log, const ValidationReport& report);

/// What does not fit together, in sentences: frames, signs, clocks, limits, and the vehicle's roll and pitch
/// loops (identified from the flight) against the models of the maps. No sentence where the data do not tell.
std::vector<std::string> flightWarnings(const FlightLog& log, const std::vector<ReplaySample>& samples,
                                        const AxisMaps& maps, const MultirotorOptions& options);

/// The node's own account against the replay's.
StatusValidation validateStatuses(const FlightLog& log, const std::vector<ReplaySample>& samples);

}  // namespace polyfly
