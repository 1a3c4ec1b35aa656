#pragma once

#include <string>

namespace polyfly {

/// Where the calibrated numbers of a problem file come from, by its key `provenance`. One line has for each
/// calibration its file and checksum, and the flights with their dates. Empty for a problem without calibrated
/// numbers, or with a provenance that nobody but its author reads.
std::string calibrationsOf(const std::string& problem);

}  // namespace polyfly
