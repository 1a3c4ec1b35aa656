#pragma once

#include <functional>
#include <string>

#include "certify/certificate.hpp"
#include "certify/region_check.hpp"
#include "offline_mpt/certify.hpp"

namespace polyfly {

/// Proves a map of a program whose exact numbers are at hand, as `certify` does, without adjustments or widened
/// coverage. `head` gives the certificate up to its first region.
CertifyReport certifyExactly(const CheckContext& context,
                             const std::function<std::string(const StatedTolerances&)>& head);

}  // namespace polyfly
