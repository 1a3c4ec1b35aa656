#include "exact_certificate.hpp"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdio>
#include <cstring>

#include "region_maps/error.hpp"
#include "region_maps/write_map.hpp"

namespace polyfly {
namespace {

std::string hex(std::uint64_t value) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(value));
  return text;
}

/// Exact and short.
std::string hex(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%a", value);
  return text;
}

template <typename Matrix>
void appendMatrix(const char* name, const Matrix& matrix, std::string& text) {
  text += std::string(name) + " " + std::to_string(matrix.rows()) + " " + std::to_string(matrix.cols());
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) text += " " + hex(matrix(i, j));
  }
  text += "\n";
}

void appendList(const char* name, const std::vector<int>& list, std::string& text) {
  text += std::string(name) + " " + std::to_string(list.size());
  for (const int value : list) text += " " + std::to_string(value);
  text += "\n";
}

std::string mapLine(const char* name, const RegionMap& map) {
  return std::string(name) + " " + hex(map.checksum()) + " " + std::to_string(map.bytes()) + "\n";
}

void writeProof(const std::string& certificate, const char* what, const std::string& path) {
  if (certificate.empty())
    throw Error(path + ": there is no certificate to write: " + what + " did not pass");
  std::vector<std::byte> bytes(certificate.size());
  std::memcpy(bytes.data(), certificate.data(), bytes.size());
  writeFileAtomically(path, bytes);
}

void appendReplaced(const ReplacedEntry& entry, std::string& text) {
  static const char* const kNames[] = {"H", "F", "f", "A"};
  text += std::string("counts ") + kNames[static_cast<std::size_t>(entry.matrix)] + " " +
          std::to_string(entry.row) + " " + std::to_string(entry.column) + " " + entry.value.get_str(16) +
          "\n";
}

}  // namespace

std::string certificateHead(const RegionMap& map, const ParametricProgram& program,
                            const Adjustment& adjustment, bool widened, const CertifyOptions& options) {
  const std::string_view problem = map.problemText();
  std::string text = "polyfly certificate 3\n";
  text += mapLine("map", map);
  text += "problem " + hex(static_cast<std::uint64_t>(XXH64(problem.data(), problem.size(), 0))) + " " +
          std::to_string(problem.size()) + "\n";
  text += "tolerances " + hex(options.law_tolerance) + " " + hex(options.plane_tolerance) + "\n";
  Eigen::MatrixXd box(program.parameterCount(), 2);
  for (int j = 0; j < program.parameterCount(); ++j)
    box.row(j) << program.parameters[static_cast<std::size_t>(j)].lower,
        program.parameters[static_cast<std::size_t>(j)].upper;
  appendMatrix("box", box, text);
  appendMatrix("H", program.H, text);
  appendMatrix("f", program.f, text);
  appendMatrix("F", program.F, text);
  appendMatrix("A", program.A, text);
  appendMatrix("b", program.b, text);
  appendMatrix("S", program.S, text);
  appendMatrix("A_theta", program.A_theta, text);
  appendMatrix("b_theta", program.b_theta, text);
  appendMatrix("E", program.E, text);
  appendMatrix("C", program.C, text);
  appendMatrix("c", program.c, text);
  appendList("equalities", program.equalities, text);
  appendList("basis", adjustment.basis, text);
  for (const ZeroCombination& proof : adjustment.implied) {
    text += "implied " + std::to_string(proof.size());
    for (const auto& [row, weight] : proof) text += " " + std::to_string(row) + " " + weight.get_str(16);
    text += "\n";
  }
  appendList("dropped", adjustment.dropped, text);
  appendList("relaxed", adjustment.relaxed, text);
  text += std::string("convexity ") + (adjustment.singular ? "singular " : "definite ") +
          hex(adjustment.penalty) + "\n";
  text += std::string("coverage ") + (widened ? "widened" : "exact") + "\n";
  for (const ReplacedEntry& entry : adjustment.replaced) appendReplaced(entry, text);
  text += "regions " + std::to_string(map.regionCount()) + "\n";
  return text;
}

std::string certificateEnd(const std::string& text) {
  return "end " + hex(static_cast<std::uint64_t>(XXH64(text.data(), text.size(), 0))) + "\n";
}

std::string reductionCertificate(const RegionMap& reduced, const RegionMap& original,
                                 const ReductionReport& report, const std::vector<std::string>& proofs) {
  std::string text = "polyfly reduction certificate 1\n";
  text += mapLine("reduced", reduced) + mapLine("original", original);
  text += "tolerances " + hex(report.law_tolerance) + " " + hex(report.slack) + "\n";
  for (std::size_t i = 0; i < proofs.size(); ++i) {
    const bool is_original = i < original.regionCount();
    const std::size_t region = is_original ? i : i - original.regionCount();
    text += (is_original ? "O " : "R ") + std::to_string(region) + proofs[i] + "\n";
  }
  return text + certificateEnd(text);
}

void writeCertificate(const CertifyReport& report, const std::string& path) {
  writeProof(report.certificate, "the map", path);
}

void writeCertificate(const ReductionReport& report, const std::string& path) {
  writeProof(report.certificate, "the reduction", path);
}

}  // namespace polyfly
