// Compares a map with direct solutions at 1000 parameters, then proves it in rational arithmetic: verify_map MAP
#include <cstdio>
#include <string>

#include "mpc_core/mpc_problem.hpp"
#include "offline_mpt/certify.hpp"
#include "offline_mpt/verify.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: verify_map MAP\n");
    return 2;
  }
  const polyfly::RegionMap map = polyfly::RegionMap::open(argv[1]);
  // A map carries the problem that it was solved from.
  const polyfly::ParametricProgram program =
      polyfly::parseProgram(std::string(map.problemText()), std::string(map.problemKind()), argv[1]);
  polyfly::VerifyOptions options;
  options.samples = 1000;
  const polyfly::VerifyReport sampled = polyfly::verify(map, program, options);
  const polyfly::CertifyReport proven = polyfly::certify(map, program);
  std::printf("greatest error of u at samples: %.3g\n", sampled.max_error);
  for (const polyfly::Defect& defect : proven.defects) std::printf("%s\n", defect.text.c_str());
  std::printf("%s\n", proven.passed() ? "proven" : "not proven");
  return sampled.passed() && proven.passed() ? 0 : 1;
} catch (const polyfly::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
