#pragma once

#include <string>

#include "certify/region_check.hpp"
#include "offline_mpt/certify.hpp"

namespace polyfly {

/// Proves a map of a program whose exact numbers are at hand, as `certify` does, without adjustments or widened
/// coverage. `head` is the certificate up to its first region.
CertifyReport certifyExactly(const CheckContext& context, const std::string& head);

}  // namespace polyfly
