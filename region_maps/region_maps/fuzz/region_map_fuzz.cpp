// libFuzzer target: opening any bytes either throws Error or gives a map on which every look-up is defined.
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <vector>

#include "../src/check_map.hpp"
#include "bad_maps.hpp"
#include "polyfly_base/error.hpp"
#include "region_maps/region_map.hpp"
#include "synthetic_map.hpp"

namespace polyfly {
namespace {

constexpr std::uint64_t kMaxChecks = 20'000;  ///< keeps one input fast: leaves and regions may overlap

/// assert, also in optimised builds.
void require(bool promise) {
  if (!promise) std::abort();
}

bool same(const Lookup& a, const Lookup& b) {
  return a.status == b.status && a.region == b.region && a.law == b.law;
}

void lookUp(const RegionMap& map, const std::vector<double>& theta) {
  const std::size_t m = map.inputs().size();
  constexpr double kUntouched = 12345.0;
  std::vector<double> u(m, kUntouched);
  const Lookup found = map.evaluate(theta.data(), u.data());
  require(same(found, map.locate(theta.data())));
  if (found.status == LookupStatus::kInside) {
    require(found.region < map.regionCount() && found.law < map.lawCount());
    require(map.contains(found.region, theta.data()));
    require(map.region(found.region).law == found.law);
  } else {
    for (const double entry : u) require(entry == kUntouched);
  }
  std::uint64_t checks = 0;
  for (std::size_t i = 0; i < map.regionCount() && checks <= kMaxChecks; ++i)
    checks += map.region(i).row_count;
  if (checks > kMaxChecks) return;
  const Lookup reference = map.locateExhaustively(theta.data());
  // The tree may leave a region out, the test of all may not.
  if (found.status == LookupStatus::kInside) {
    require(reference.status == LookupStatus::kInside);
  } else if (found.status != LookupStatus::kOutsidePartition) {
    require(reference.status == found.status);
  }
}

void touchAll(const RegionMap& map) {
  double sum = map.period() + map.tolerance();
  const std::size_t p = map.parameters().size();
  for (std::size_t i = 0; i < map.planeCount(); ++i) sum += map.plane(i)[p];
  for (std::size_t i = 0; i < map.lawCount(); ++i) sum += map.law(i)[(p + 1) * map.inputs().size() - 1];
  for (std::size_t i = 0; i < map.regionCount(); ++i) {
    const RegionView region = map.region(i);
    if (region.row_count > 0) sum += region.rows[region.row_count - 1];
    if (region.active_count > 0) sum += region.active[region.active_count - 1];
  }
  sum += static_cast<double>(map.name().size() + map.problemText().size() + map.problemKind().size() +
                             map.solverStatus().size() + map.solverNotes().size());
  const volatile double sink = sum;  // keeps the reads
  (void)sink;
}

void tryMap(const std::vector<std::byte>& bytes) {
  AlignedBytes copy(bytes);
  try {
    const RegionMap map = RegionMap::view(copy.data(), copy.size(), "fuzz");
    touchAll(map);
    if (map.cost().region_checks > kMaxChecks) return;
    const std::size_t p = map.parameters().size();
    std::vector<double> theta(p);
    for (const double place : {0.0, 0.5, 1.0, 0.25, 0.7, 1.5}) {
      for (std::size_t i = 0; i < p; ++i) {
        const Signal& range = map.parameters()[i];
        theta[i] = (1.0 - place) * range.lower + place * range.upper;
      }
      lookUp(map, theta);
    }
    for (const double value : {std::nan(""), -std::numeric_limits<double>::infinity()}) {
      theta.assign(p, 0.0);
      theta[bytes.size() / 64 % p] = value;
      lookUp(map, theta);
    }
  } catch (const Error&) {
  }
}

/// Makes frame and cost right, so that what the fuzzer changed meets the structural rules and then the
/// look-ups.
void repair(std::vector<std::byte>& bytes) {
  format::Header header;
  std::memcpy(&header, bytes.data(), sizeof(header));
  std::memcpy(header.magic, format::kMagic, sizeof(header.magic));
  header.byte_order = format::kByteOrder;
  header.version = format::kVersion;
  AlignedBytes copy(bytes);
  try {
    const LookupCost cost = checkStructure(copy.data(), copy.size(), "fuzz").cost;
    header.depth = cost.depth;
    header.region_checks = cost.region_checks;
    header.multiply_adds = cost.multiply_adds;
  } catch (const Error&) {
  }
  std::memcpy(bytes.data(), &header, sizeof(header));
  repairFrame(bytes);
}

}  // namespace
}  // namespace polyfly

// NOLINTNEXTLINE(readability-identifier-naming): libFuzzer calls it by this name.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto* const first = reinterpret_cast<const std::byte*>(data);
  std::vector<std::byte> bytes(first, first + size);
  polyfly::tryMap(bytes);
  if (size >= sizeof(polyfly::format::Header)) {
    polyfly::repair(bytes);
    polyfly::tryMap(bytes);
  }
  return 0;
}
