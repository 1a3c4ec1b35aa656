#include "certify/reduction/reduction_certificate.hpp"

#include "certify/certificate.hpp"
#include "region_maps/region_map.hpp"
#include "support/certificate_text.hpp"

namespace polyfly {

std::string reductionCertificate(const RegionMap& reduced, const RegionMap& original,
                                 const ReductionReport& report, const std::string& drops,
                                 const std::vector<std::string>& proofs) {
  std::string text = "polyfly reduction certificate 1\n";
  text += mapLine("reduced", reduced) + mapLine("original", original);
  text += "tolerances " + hex(report.law_tolerance) + " " + hex(report.slack) + "\n" + drops;
  for (std::size_t i = 0; i < proofs.size(); ++i) {
    const bool is_original = i < original.regionCount();
    const std::size_t region = is_original ? i : i - original.regionCount();
    text += (is_original ? "O " : "R ") + std::to_string(region) + proofs[i] + "\n";
  }
  return text + certificateEnd(text);
}

void writeCertificate(const ReductionReport& report, const std::string& path) {
  writeProof(report.certificate, "the reduction", path);
}

}  // namespace polyfly
