#pragma once

#include <string>
#include <vector>

#include "offline_mpt/verify_reduction.hpp"

namespace polyfly {

/// Proves that a reduced map answers only within 8 tolerances of each row of a region, where its leaves test some rows
/// only: "Look-ups" in CERTIFICATE.md. What is not proven is a defect. Appends the lines of the certificate to `text`.
/// False when stopped.
bool proveAnswers(const RegionMap& reduced, const ReductionOptions& options, std::string& text,
                  std::vector<ReductionDefect>& defects);

}  // namespace polyfly
