#pragma once

#include <cstddef>
#include <cstdint>
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

/// Magic, byte order, version and file size, for a file of `size` bytes. Reads its first bytes alone, at most a header.
/// Throws Error starting with `name`.
void checkHead(const void* head, std::uint64_t size, const std::string& name);

/// The checksum, once checkHead has passed. Throws Error.
void checkSum(const void* data, std::size_t size, const std::string& name);

/// All other rules of FORMAT.md but the cost in the header. checkHead must have passed;
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
