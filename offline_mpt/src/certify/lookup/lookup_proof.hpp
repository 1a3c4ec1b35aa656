#pragma once

#include <string>
#include <vector>

#include "certify/lookup/leaf_walk.hpp"

namespace polyfly {

/// Proves what look-ups answer, leaf by leaf: "Look-ups" in CERTIFICATE.md. What is wrong, or cannot be proven, is a
/// defect. Appends the lines of the certificate to `text`. False when stopped.
bool proveLookups(const CheckContext& context, const std::vector<RegionCheck>& checks,
                  const std::vector<std::vector<FacetBehind>>& behind, bool widened, std::string& text,
                  std::vector<Defect>& defects);

}  // namespace polyfly
