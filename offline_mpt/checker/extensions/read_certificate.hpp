#pragma once

#include <memory>
#include <string>

#include "core/certificate.hpp"

namespace checker {

/// Reads a certificate of any kind. Where it has no line of an extension, core/ alone confirms it. Throws Refused.
std::unique_ptr<Certificate> readCertificate(const std::string& text, const Map& map);

}  // namespace checker
