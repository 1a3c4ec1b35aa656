#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace polyfly {

/// Greatest chunk that is unpacked [bytes]; recorders make chunks of less than a megabyte by default.
constexpr std::size_t kGreatestChunk = std::size_t{1} << 28;

/// Unpacks a chunk ("none", "bz2", "lz4") that says to hold `size` bytes. Returns what is wrong, or an empty
/// string.
std::string unpackChunk(const std::string& compression, const std::uint8_t* data, std::size_t packed,
                        std::size_t size, std::vector<std::uint8_t>* out);

}  // namespace polyfly
