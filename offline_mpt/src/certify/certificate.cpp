#include "certify/certificate.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdio>

#include "polyfly_base/error.hpp"
#include "polyfly_base/write_file.hpp"
#include "region_maps/region_map.hpp"
#include "support/certificate_text.hpp"

namespace polyfly {
std::string mapLine(const char* name, const RegionMap& map) {
  return std::string(name) + " " + hex(map.checksum()) + " " + std::to_string(map.bytes()) + "\n";
}

void writeProof(const std::string& certificate, const char* what, const std::string& path) {
  if (certificate.empty())
    throw Error(path + ": there is no certificate to write: " + what + " did not pass");
  writeFileAtomically(path, certificate);
}

std::string certificateHead(const RegionMap& map, const ParametricProgram& program,
                            const ProgramPerturbation& adjustment, bool widened,
                            const StatedTolerances& tolerances) {
  std::string text = "polyfly certificate 6\n";
  text += mapLine("map", map);
  text += problemLine(map.problemText());
  text += "tolerances " + hex(tolerances.law) + " " + hex(tolerances.plane) + "\n";
  text += programLines(program);
  appendList("basis", adjustment.basis, text);
  for (const ZeroCombination& proof : adjustment.implied) {
    text += "implied " + std::to_string(proof.size());
    for (const auto& [row, weight] : proof) text += " " + std::to_string(row) + " " + weight.get_str(16);
    text += "\n";
  }
  if (!adjustment.dropped.empty()) appendList("dropped", adjustment.dropped, text);
  if (!adjustment.weights.empty()) appendList("weights", adjustment.weights, text);
  const char* const convexity = program.H.isZero(0.0) ? "linear" : "definite";
  text += std::string("convexity ") + convexity + " " + hex(adjustment.penalty) + "\n";
  text += std::string("coverage ") + (widened ? "widened" : "exact") + "\n";
  text += "regions " + std::to_string(map.regionCount()) + "\n";
  return text;
}

std::string certificateEnd(const std::string& text) {
  return "end " + hex(static_cast<std::uint64_t>(XXH64(text.data(), text.size(), 0))) + "\n";
}

void writeCertificate(const CertifyReport& report, const std::string& path) {
  writeProof(report.certificate, "the map", path);
}

}  // namespace polyfly
