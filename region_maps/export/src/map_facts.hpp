#pragma once

#include <cstdint>
#include <string>

#include "c_text.hpp"

namespace polyfly {

/// Keys that all templates share: name, sizes, checksums, words of the type.
Replacements sharedKeys(const RegionMap& map, const ExportOptions& options);

}  // namespace polyfly
