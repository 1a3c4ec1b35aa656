#pragma once

#include <string>

namespace polyfly {

/// A problem text in which `range: {from: FILE, name: NAME}` of a disturbance stands for the range that FILE
/// (of `calibrate disturbance`, or any YAML with `disturbances: [{name, unit, range}]`) gives it; a file name
/// counts from the folder of the problem file `path`. Each is replaced by the numbers as FILE has them, so
/// that the text, and the map that carries it, needs no other file; a comment tells where they are from.
/// Throws Error: so where FILE has unknown keys, is a calibration of another kind, or one of a fixed wing.
std::string withCitedRanges(const std::string& text, const std::string& path);

}  // namespace polyfly
