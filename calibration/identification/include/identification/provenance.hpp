#pragma once

#include "polyfly_base/provenance.hpp"

namespace polyfly {

/// Version of the identification, written into every result; raised when the same data give other numbers.
constexpr const char* kIdentificationVersion = "3";

}  // namespace polyfly
