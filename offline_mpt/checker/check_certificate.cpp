// check_certificate CERTIFICATE --map MAP [--problem FILE]: confirms a certificate by substitution, as
// offline_mpt/CERTIFICATE.md states it. GMP only; shares no code with the solver or with what wrote the
// certificate.
#include <cstdio>

#include "certificate.hpp"

namespace {

constexpr char kUsage[] =
    "usage: check_certificate CERTIFICATE --map MAP [--problem FILE]\n"
    "Confirms in rational arithmetic that MAP is the complete solution of its problem, from a certificate "
    "that\n"
    "'offline_mpt verify --exact' wrote. With --problem, the certificate must be of that problem file.\n"
    "Exit code 0: confirmed, 1: refused, 2: bad command line.\n";

}  // namespace

int main(int argc, char** argv) {
  std::string certificate, map, problem;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    std::string* target = argument == "--map" ? &map : argument == "--problem" ? &problem : nullptr;
    if (argument == "--help") return std::fputs(kUsage, stdout) < 0 ? 1 : 0;
    const bool valid = target != nullptr ? ++k < argc : certificate.empty() && argument[0] != '-';
    if (!valid) return std::fputs(kUsage, stderr) < 0 ? 1 : 2;
    (target != nullptr ? *target : certificate) = argv[k];
  }
  if (certificate.empty() || map.empty()) return std::fputs(kUsage, stderr) < 0 ? 1 : 2;
  try {
    const checker::Map content(checker::readFile(map));
    const checker::Certificate proof(checker::readFile(certificate), content);
    if (!problem.empty()) proof.compareProblem(checker::readFile(problem));
    proof.check();
    std::printf("confirmed: %zu regions\n%s", content.regions.size(), proof.conditions().c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "check_certificate: %s: refused: %s\n", certificate.c_str(), error.what());
    return 1;
  }
  return 0;
}
