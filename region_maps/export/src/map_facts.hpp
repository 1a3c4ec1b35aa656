#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "c_text.hpp"
#include "code_tables.hpp"

namespace polyfly {

/// Keys that all templates share: name, sizes, checksums, words of the type.
Replacements sharedKeys(const RegionMap& map, const ExportOptions& options);

/// "xxh64:" and sixteen hexadecimal digits.
std::string checksumText(std::uint64_t checksum);

/// Bytes of all constant tables.
std::size_t tableBytes(const CodeTables& tables, ExportType type);

}  // namespace polyfly
