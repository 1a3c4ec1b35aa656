#pragma once

#include <memory>
#include <string>

#include "core/certificate.hpp"

namespace checker {

/// As readCertificate, and certificates of robust maps. The first line tells the kind. Throws Refused.
std::unique_ptr<Certificate> readMapCertificate(const std::string& text, const Map& map);

}  // namespace checker
