#pragma once

#include <cstdint>
#include <string>

/// Checksums tell damaged files, and a certificate of another map. No statement rests on them: all that a certificate says
/// is checked against the map at hand.
namespace checker {

std::uint64_t xxh64(const std::string& bytes);  ///< seed 0
std::string hexText(std::uint64_t value);       ///< 16 digits

/// The lines of a certificate before the last, which has their checksum. Throws Refused.
std::string unsealed(const std::string& text);

}  // namespace checker
