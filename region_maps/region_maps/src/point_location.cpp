#include "point_location.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

namespace polyfly {
namespace {

/// The look-ups for kParameters parameters, 0: any number. Constants in place of the number let the compiler
/// unroll.
template <std::uint32_t kParameters>
struct PointLocation {
  using Tables = LookupTables;

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
    // The box is finite, so a parameter in it is finite.
    if (inside) return LookupStatus::kInside;
    for (std::size_t i = 0; i < p; ++i) {
      if (!std::isfinite(theta[i])) return LookupStatus::kNotFinite;
    }
    return LookupStatus::kOutsideBox;
  }

  static double rowViolation(const Tables& tables, std::int32_t row, const double* theta) noexcept {
    const std::size_t p = size(tables);
    const std::size_t plane = static_cast<std::size_t>(row < 0 ? -row : row) - 1;
    return negatedIf(row < 0, distance(tables.planes + plane * (p + 1), theta, p));
  }

  /// How far theta violates the row that it violates most, of the region's rows that `tests` names. At most 0
  /// within the region, infinite when it is more than the tolerance.
  static double violation(const Tables& tables, std::size_t region, std::uint32_t tests,
                          const double* theta) noexcept {
    const MapContent::Region& r = tables.regions[region];
    const std::int32_t* const rows = tables.rows + r.first_row;
    double greatest = -kInfinity;
    for (std::uint32_t i = 0; i < r.row_count; ++i) {
      if (!isTested(tests, i)) continue;
      const double beyond = rowViolation(tables, rows[i], theta);
      if (!(beyond <= tables.tolerance)) return kInfinity;
      greatest = std::max(greatest, beyond);
    }
    return greatest;
  }

  static bool contains(const Tables& tables, std::size_t region, const double* theta) noexcept {
    return violation(tables, region, MapContent::kAllRows, theta) <= tables.tolerance;
  }

  /// The first of the regions offered that holds theta; failing that, the one that theta violates least,
  /// within the tolerance. A steep law beside a sliver would be off by more than rounding if just any within
  /// the tolerance were taken.
  struct Best {
    Lookup found{LookupStatus::kOutsidePartition};
    double least = kInfinity;

    /// A region and its violation. True when no later one can be better.
    bool offer(const Tables& tables, std::uint32_t region, std::uint32_t tests,
               const double* theta) noexcept {
      const double beyond = violation(tables, region, tests, theta);
      if (!(beyond < least)) return false;
      least = beyond;
      found = {LookupStatus::kInside, region, tables.regions[region].law};
      return beyond <= 0.0;
    }
  };

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
    Best best;
    for (std::uint32_t i = 0; i < leaf.count; ++i) {
      const std::uint32_t tests =
          tables.tests == nullptr ? MapContent::kAllRows : tables.tests[leaf.first + i];
      if (best.offer(tables, candidates[i], tests, theta)) break;
    }
    return best.found;
  }

  static Lookup evaluate(const Tables& tables, const double* theta, double* u) noexcept {
    return apply(tables, locate(tables, theta), theta, u);
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
    Best best;
    for (std::size_t i = 0; i < regions; ++i) {
      if (best.offer(tables, static_cast<std::uint32_t>(i), MapContent::kAllRows, theta)) break;
    }
    return best.found;
  }

  static LookupFunctions functions() noexcept { return {locate, evaluate, locateExhaustively, contains}; }
};

}  // namespace

LookupFunctions lookupFunctionsFor(std::uint32_t parameters) noexcept {
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
