#pragma once

#include <cstdint>
#include <string>

namespace polyfly {

/// Where numbers come from.
struct Provenance {
  std::string file;  ///< name without folders
  /// Of the bytes, "xxh64:" and sixteen hexadecimal digits; `xxhsum -H64` gives the same.
  std::string checksum;
  std::string recorded;  ///< date of the data (UTC, ISO 8601), or empty where they do not tell
};

/// Reads the file once, in pieces. Throws Error when it cannot be read.
Provenance provenanceOf(const std::string& path);

/// A checksum as sixteen hexadecimal digits.
std::string hexDigits(std::uint64_t checksum);

/// Checksum of a text, in the form of Provenance::checksum.
std::string checksumOf(const std::string& text);

/// A string in double quotes for YAML, with what needs it escaped.
std::string yamlString(const std::string& text);

}  // namespace polyfly
