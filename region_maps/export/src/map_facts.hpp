#pragma once

#include <cstdint>
#include <string>

#include "c_text.hpp"

namespace polyfly {

/// Keys that all templates share: name, sizes, checksums, words of the type.
Replacements sharedKeys(const RegionMap& map, const ExportOptions& options);

/// "xxh64:" and sixteen hexadecimal digits.
std::string checksumText(std::uint64_t checksum);

}  // namespace polyfly
