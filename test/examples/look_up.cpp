// Looks the law up at one parameter, with the reader alone: look_up MAP THETA...
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"

int main(int argc, char** argv) try {
  if (argc < 2) {
    std::fprintf(stderr, "usage: look_up MAP THETA...\n");
    return 2;
  }
  const polyfly::RegionMap map = polyfly::RegionMap::open(argv[1]);
  std::vector<double> theta;
  for (int i = 2; i < argc; ++i) theta.push_back(std::strtod(argv[i], nullptr));
  if (theta.size() != map.parameters().size()) {
    std::fprintf(stderr, "%s has %zu parameters:", argv[1], map.parameters().size());
    for (const polyfly::Signal& parameter : map.parameters())
      std::fprintf(stderr, " %s", parameter.name.c_str());
    std::fprintf(stderr, "\n");
    return 2;
  }
  std::vector<double> u(map.inputs().size());
  if (map.evaluate(theta.data(), u.data()).status != polyfly::LookupStatus::kInside) {
    std::printf("outside\n");
    return 1;
  }
  for (const double value : u) std::printf("%.17g\n", value);
  return 0;
} catch (const polyfly::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
