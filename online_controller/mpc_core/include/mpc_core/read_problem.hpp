#pragma once

#include <string>
#include <vector>

namespace polyfly {

/// The text of a problem file (region_maps/problems/README.md), with the numbers of the calibrations that its key
/// `calibration` names. The key has one file that `calibrate` wrote or a list of them, with paths from the problem's
/// folder. It becomes a comment, and `provenance` at the end tells what was taken from where. The result needs no
/// other file, and is what a map carries. Throws Error naming file, field and rule; also when the data of a
/// calibration do not support its numbers.
std::string readProblem(const std::string& path);

/// The files that a problem or parametric program is read from, as far as the file can be understood. These are the
/// file itself, those that its key `calibration` names, and those that its disturbances take their ranges from.
std::vector<std::string> filesOfProblem(const std::string& path);

}  // namespace polyfly
