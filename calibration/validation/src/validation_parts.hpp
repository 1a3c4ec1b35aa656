#pragma once

#include <string>
#include <vector>

#include "validation/validation.hpp"

namespace polyfly {

// The parts of a validation.

/// One axis' map against the samples: its use, excursions, agreement with the online solver, look-up times.
AxisValidation validateAxis(const std::vector<ReplayedFlight>& flights, const RegionMap& map,
                            std::size_t index);

/// Recorded commands against the replay's and against the bounds of the options.
CommandValidation validateCommands(const std::vector<ReplayedFlight>& flights);

/// What the record lacks, and what does not fit together, in sentences: parts of it, stamps, commands, frames, parameters.
/// No sentence where the data do not tell.
std::vector<std::string> warningsOf(const ReplayedFlight& flight, const AxisMaps& maps,
                                    const ValidationReport& report);

/// The node's own account against the replay's, and against the laws of the maps.
StatusValidation validateStatuses(const std::vector<ReplayedFlight>& flights, const AxisMaps& maps);

}  // namespace polyfly
