#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "region_maps/format.hpp"
#include "region_maps/lookup.hpp"

namespace polyfly {

/// What the checks find on their way.
struct MapFacts {
  /// All strings of the text section, in order; they point into the file.
  std::vector<std::string_view> texts;
  LookupCost cost;
};

/// Size, magic, byte order, version, file size, checksum. Throws Error starting with `name`.
void checkFrame(const void* data, std::size_t size, const std::string& name);

/// All other rules of FORMAT.md but the cost in the header. The frame must be right, the checksum excepted;
/// `data` must be aligned to 8 bytes. Takes time and memory in proportion to `size`. Throws Error.
MapFacts checkStructure(const void* data, std::size_t size, const std::string& name);

/// The cost in the header against the one computed. Throws Error.
void checkCost(const format::Header& header, const LookupCost& cost, const std::string& name);

/// Start of a section in the file at `data`, whose header was checked.
template <typename T>
const T* sectionStart(const void* data, const format::Header& header, format::Section section) noexcept {
  return reinterpret_cast<const T*>(static_cast<const unsigned char*>(data) +
                                    header.sections[section].offset);
}

}  // namespace polyfly
