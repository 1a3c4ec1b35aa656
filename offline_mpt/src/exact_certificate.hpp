#pragma once

#include <string>

#include "exact_program.hpp"
#include "offline_mpt/certify.hpp"

namespace polyfly {

/// The certificate up to the first region: what it is about.
std::string certificateHead(const RegionMap& map, const ParametricProgram& program,
                            const Adjustment& adjustment, const CertifyOptions& options);

/// The last line: a checksum of all before it.
std::string certificateEnd(const std::string& text);

}  // namespace polyfly
