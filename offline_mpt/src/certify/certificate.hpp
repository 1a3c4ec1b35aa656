#pragma once

#include <string>

#include "exact_kkt/exact_program.hpp"
#include "offline_mpt/certify.hpp"

namespace polyfly {

/// What a certificate says that laws and planes keep to.
struct StatedTolerances {
  double law = 0.0, plane = 0.0;
};

/// The certificate up to the first region: what it is about.
std::string certificateHead(const RegionMap& map, const ParametricProgram& program,
                            const ProgramPerturbation& adjustment, bool widened,
                            const StatedTolerances& tolerances);

/// The line that names a map by its checksum and size.
std::string mapLine(const char* name, const RegionMap& map);

/// The last line: a checksum of all before it.
std::string certificateEnd(const std::string& text);

/// Writes the certificate of `what` to `path`; throws Error where it is empty: there is no proof.
void writeProof(const std::string& certificate, const char* what, const std::string& path);

}  // namespace polyfly
