// Prints the answers of all ways to look a map up, every bit of them: lookup_bits MAP COUNT. The parameters are random ones in
// the box, slightly outside of it, and on the planes of the map.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <vector>

#include "region_maps/region_map.hpp"

namespace {

using polyfly::Lookup;
using polyfly::RegionMap;

// Share of half the range by which parameters leave the box.
constexpr double kBeyond = 0.05;

/// From 0 to 1, the same on every machine.
double uniform(std::mt19937_64& random) { return static_cast<double>(random() >> 11) * 0x1p-53; }

/// Moves theta to the nearest point of a plane, up to rounding, in parameters whose range is [-1, 1].
void moveOnto(const RegionMap& map, const double* plane, std::vector<double>& theta) {
  double distance = plane[theta.size()];
  double norm = 0.0;
  std::vector<double> step(theta.size());
  for (std::size_t j = 0; j < theta.size(); ++j) {
    const double half = (map.parameters()[j].upper - map.parameters()[j].lower) / 2.0;
    step[j] = plane[j] * half * half;
    distance -= plane[j] * theta[j];
    norm += plane[j] * step[j];
  }
  for (std::size_t j = 0; j < theta.size() && norm > 0.0; ++j) theta[j] += step[j] * distance / norm;
}

void print(const Lookup& found) {
  std::printf(" %d/%" PRIu32 "/%" PRIu32, static_cast<int>(found.status), found.region, found.law);
}

void printAnswers(const RegionMap& map, const std::vector<double>& theta) {
  std::vector<double> u(map.inputs().size(), 0.0);
  print(map.evaluate(theta.data(), u.data()));
  for (const double value : u) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    std::printf(" %016" PRIx64, bits);
  }
  print(map.locateExhaustively(theta.data()));
  std::printf("\n");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const RegionMap map = RegionMap::open(argv[1]);
  std::mt19937_64 random(1);
  std::vector<double> theta(map.parameters().size());
  for (int k = 0; k < std::atoi(argv[2]); ++k) {
    for (std::size_t j = 0; j < theta.size(); ++j) {
      const polyfly::Signal& range = map.parameters()[j];
      const double half = (range.upper - range.lower) / 2.0;
      const double share = (1.0 + kBeyond * (k % 4)) * (2.0 * uniform(random) - 1.0);
      theta[j] = (range.lower + range.upper) / 2.0 + half * share;
    }
    const std::uint64_t plane = random() % map.planeCount();
    if (k % 2 == 1) moveOnto(map, map.plane(static_cast<std::size_t>(plane)), theta);
    printAnswers(map, theta);
  }
  return 0;
}
