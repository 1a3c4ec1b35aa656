#pragma once

#include <string>
#include <vector>

#include "offline_mpt/verify_reduction.hpp"

namespace polyfly {

/// The certificate of a reduction: lines of dropped rows, then a proof for each region of the original, then of the
/// reduced map.
std::string reductionCertificate(const RegionMap& reduced, const RegionMap& original,
                                 const ReductionReport& report, const std::string& drops,
                                 const std::vector<std::string>& proofs);

}  // namespace polyfly
