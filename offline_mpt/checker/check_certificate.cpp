// check_certificate CERTIFICATE --map MAP [--problem FILE]: confirms a certificate by substitution, as
// offline_mpt/CERTIFICATE.md states it. GMP only; shares no code with the solver or with what wrote the
// certificate.
#include <cstdio>

#include "certificate.hpp"
#include "offline_mpt/out_of_memory.hpp"
#include "reduction.hpp"

namespace {

constexpr char kUsage[] =
    "usage: check_certificate CERTIFICATE --map MAP [--problem FILE]\n"
    "       check_certificate CERTIFICATE --map REDUCED --reduced-from ORIGINAL\n"
    "Confirms in rational arithmetic that MAP is the complete solution of its problem, from a certificate "
    "that\n"
    "'offline_mpt verify --exact' wrote. With --problem, the certificate must be of that problem file.\n"
    "With --reduced-from, that REDUCED answers as ORIGINAL does, from a certificate that\n"
    "'offline_mpt verify --reduced-from' wrote; ORIGINAL has a certificate of its own.\n"
    "Exit code 0: confirmed, 1: refused, 2: bad command line, or out of memory.\n";

struct Files {
  std::string certificate, map, problem, original;
};

void confirm(const Files& files) {
  using checker::readFile;
  const checker::Map map(readFile(files.map));
  std::string conditions;
  if (files.original.empty()) {
    const checker::Certificate proof(readFile(files.certificate), map);
    if (!files.problem.empty()) proof.compareProblem(readFile(files.problem));
    proof.check();
    conditions = proof.conditions();
  } else {
    const checker::Map original(readFile(files.original));
    const checker::Reduction proof(readFile(files.certificate), map, original);
    proof.check();
    conditions = proof.conditions();
  }
  std::printf("confirmed: %zu regions\n%s", map.regions.size(), conditions.c_str());
}

int usage(std::FILE* stream, int code) { return std::fputs(kUsage, stream) < 0 ? 1 : code; }

}  // namespace

int main(int argc, char** argv) {
  polyfly::endInWordsWithoutMemory("check_certificate");
  Files files;
  for (int k = 1; k < argc; ++k) {
    const std::string argument = argv[k];
    if (argument == "--help") return usage(stdout, 0);
    std::string* const target = argument == "--map"            ? &files.map
                                : argument == "--problem"      ? &files.problem
                                : argument == "--reduced-from" ? &files.original
                                                               : nullptr;
    const bool valid = target != nullptr ? ++k < argc : files.certificate.empty() && argument[0] != '-';
    if (!valid) return usage(stderr, 2);
    (target != nullptr ? *target : files.certificate) = argv[k];
  }
  const bool both = !files.problem.empty() && !files.original.empty();
  if (files.certificate.empty() || files.map.empty() || both) return usage(stderr, 2);
  try {
    confirm(files);
  } catch (const std::bad_alloc&) {  // says nothing about the proof
    polyfly::out_of_memory::end("out of memory");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "check_certificate: %s: refused: %s\n", files.certificate.c_str(), error.what());
    return 1;
  }
  return 0;
}
