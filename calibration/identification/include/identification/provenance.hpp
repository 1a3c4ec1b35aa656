#pragma once

#include <string>

#include "polyfly_base/provenance.hpp"

namespace polyfly {

/// Version of the identification, written into every result; raised when the same data give other numbers.
constexpr const char* kIdentificationVersion = "4";

/// The entry as a YAML map in one line: file, checksum, recorded.
std::string provenanceMap(const Provenance& provenance);

}  // namespace polyfly
