#pragma once

#include <string>
#include <vector>

#include "exact_program.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/verify_reduction.hpp"

namespace polyfly {

/// The certificate up to the first region: what it is about.
std::string certificateHead(const RegionMap& map, const ParametricProgram& program,
                            const Adjustment& adjustment, bool widened, const CertifyOptions& options);

/// The certificate of a reduction: a proof for each region of the original, then of the reduced map.
std::string reductionCertificate(const RegionMap& reduced, const RegionMap& original,
                                 const ReductionReport& report, const std::vector<std::string>& proofs);

/// The last line: a checksum of all before it.
std::string certificateEnd(const std::string& text);

}  // namespace polyfly
