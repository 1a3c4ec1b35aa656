#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "region_maps/region_map.hpp"

namespace polyfly {

/// The look-ups for kParameters parameters, 0: any number. Constants in place of the number let the compiler
/// unroll.
template <std::uint32_t kParameters>
struct RegionMap::PointLocation {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();

  static std::size_t size(const Tables& tables) noexcept {
    return kParameters != 0 ? kParameters : tables.parameters;
  }

  /// Terms [kFirst, kEnd) of a . theta - c, added by halves: the additions do not wait for one another.
  template <std::size_t kFirst, std::size_t kEnd>
  static double sumTerms(const double* plane, const double* theta) noexcept {
    if constexpr (kEnd - kFirst > 1) {
      constexpr std::size_t kMiddle = (kFirst + kEnd + 1) / 2;
      return sumTerms<kFirst, kMiddle>(plane, theta) + sumTerms<kMiddle, kEnd>(plane, theta);
    } else if constexpr (kFirst < kParameters) {
      return plane[kFirst] * theta[kFirst];
    } else {
      return -plane[kFirst];
    }
  }

  /// a . theta - c. The tree and both sides of a plane use this one number, so that regions leave no gap
  /// between them.
  static double distance(const double* plane, const double* theta, std::size_t p) noexcept {
    if constexpr (kParameters != 0) {
      return sumTerms<0, kParameters + 1>(plane, theta);
    } else {
      double sum = 0.0;
      for (std::size_t i = 0; i < p; ++i) sum += plane[i] * theta[i];
      return sum - plane[p];
    }
  }

  /// value or -value, by its bit: a branch here would be guessed wrong every other time.
  static double negatedIf(bool negative, double value) noexcept {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &value, sizeof bits);
    bits ^= static_cast<std::uint64_t>(negative) << 63;
    std::memcpy(&value, &bits, sizeof bits);
    return value;
  }

  /// kInside, unless theta is out of the box.
  static LookupStatus testBox(const Tables& tables, const double* theta) noexcept {
    const std::size_t p = size(tables);
    bool inside = true;
    for (std::size_t i = 0; i < p; ++i) {
      inside &= (theta[i] >= tables.box[2 * i]) & (theta[i] <= tables.box[2 * i + 1]);
    }
    if (inside) return LookupStatus::kInside;  // the box is finite, so theta is
    for (std::size_t i = 0; i < p; ++i) {
      if (!std::isfinite(theta[i])) return LookupStatus::kNotFinite;
    }
    return LookupStatus::kOutsideBox;
  }

  /// How far theta violates the row of the region that it violates most; <= 0 within the region, infinite
  /// when it is more than the tolerance.
  static double violation(const Tables& tables, std::size_t region, const double* theta) noexcept {
    const std::size_t p = size(tables);
    const MapContent::Region& r = tables.regions[region];
    const std::int32_t* const rows = tables.rows + r.first_row;
    double greatest = -kInfinity;
    for (std::uint32_t i = 0; i < r.row_count; ++i) {
      const std::int32_t row = rows[i];
      const std::size_t plane = static_cast<std::size_t>(row < 0 ? -row : row) - 1;
      const double beyond = negatedIf(row < 0, distance(tables.planes + plane * (p + 1), theta, p));
      if (!(beyond <= tables.tolerance)) return kInfinity;
      greatest = std::max(greatest, beyond);
    }
    return greatest;
  }

  static bool contains(const Tables& tables, std::size_t region, const double* theta) noexcept {
    return violation(tables, region, theta) <= tables.tolerance;
  }

  /// The first of `count` regions that holds theta; failing that, the one that theta violates least, within
  /// the tolerance. A steep law beside a sliver would be off by more than rounding if just any within the
  /// tolerance were taken. Fallback regions, which come last, count as farther away by the handicap.
  template <class Region>
  static Lookup best(const Tables& tables, std::size_t count, const double* theta,
                     Region&& regionAt) noexcept {
    Lookup found{LookupStatus::kOutsidePartition};
    double least = kInfinity;
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t region = regionAt(i);
      double beyond = violation(tables, region, theta);
      if (region >= tables.first_fallback) beyond = std::max(beyond, 0.0) + tables.handicap;
      if (!(beyond < least)) continue;
      least = beyond;
      found = {LookupStatus::kInside, region, tables.regions[region].law};
      if (beyond <= 0.0) break;
    }
    return found;
  }

  static Lookup locate(const Tables& tables, const double* theta) noexcept {
    const LookupStatus box = testBox(tables, theta);
    if (box != LookupStatus::kInside) return {box};
    const std::size_t p = size(tables);
    std::uint32_t child = tables.root;
    // The branch is meant: guessing it lets the processor fetch the next node early, and was measured to be
    // twice as fast as choosing the child by arithmetic.
    while ((child & MapContent::kLeaf) == 0) {
      const MapContent::Node& node = tables.nodes[child];
      if (distance(tables.planes + node.plane * (p + 1), theta, p) <= 0.0) {
        child = node.below;
      } else {
        child = node.above;
      }
    }
    const MapContent::Leaf& leaf = tables.leaves[child & ~MapContent::kLeaf];
    const std::uint32_t* const candidates = tables.candidates + leaf.first;
    return best(tables, leaf.count, theta, [=](std::size_t i) noexcept { return candidates[i]; });
  }

  static Lookup locateFrom(const Tables& tables, const double* theta, std::uint32_t last) noexcept {
    if (last < tables.first_fallback && violation(tables, last, theta) <= 0.0 &&
        testBox(tables, theta) == LookupStatus::kInside) {
      return {LookupStatus::kInside, last, tables.regions[last].law};
    }
    return locate(tables, theta);
  }

  static Lookup evaluate(const Tables& tables, const double* theta, double* u) noexcept {
    return apply(tables, locate(tables, theta), theta, u);
  }

  static Lookup evaluateFrom(const Tables& tables, const double* theta, std::uint32_t last,
                             double* u) noexcept {
    return apply(tables, locateFrom(tables, theta, last), theta, u);
  }

  static Lookup apply(const Tables& tables, const Lookup& found, const double* theta, double* u) noexcept {
    if (found.status != LookupStatus::kInside) return found;
    const std::size_t p = size(tables);
    const double* row = tables.laws + std::size_t{found.law} * tables.inputs * (p + 1);
    for (std::uint32_t j = 0; j < tables.inputs; ++j, row += p + 1) {
      double sum = row[p];
      for (std::size_t i = 0; i < p; ++i) sum += row[i] * theta[i];
      u[j] = sum;
    }
    return found;
  }

  static Lookup locateExhaustively(const Tables& tables, std::size_t regions, const double* theta) noexcept {
    const LookupStatus box = testBox(tables, theta);
    if (box != LookupStatus::kInside) return {box};
    return best(tables, regions, theta, [](std::size_t i) noexcept { return static_cast<std::uint32_t>(i); });
  }

  static Functions functions() noexcept {
    return {locate, locateFrom, evaluate, evaluateFrom, locateExhaustively, contains};
  }
};

RegionMap::Functions RegionMap::functionsFor(std::uint32_t parameters) noexcept {
  switch (parameters) {
    case 1:
      return PointLocation<1>::functions();
    case 2:
      return PointLocation<2>::functions();
    case 3:
      return PointLocation<3>::functions();
    case 4:
      return PointLocation<4>::functions();
    case 5:
      return PointLocation<5>::functions();
    case 6:
      return PointLocation<6>::functions();
    case 7:
      return PointLocation<7>::functions();
    case 8:
      return PointLocation<8>::functions();
    default:
      return PointLocation<0>::functions();
  }
}

}  // namespace polyfly
