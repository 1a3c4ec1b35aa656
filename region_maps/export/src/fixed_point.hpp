#pragma once

#include <cstdint>
#include <vector>

namespace polyfly {

class RegionMap;
struct CodeTables;

/// Greatest size of all 16-bit numbers of the code.
constexpr int kGreatestWord = 32767;

/// Scales of code of 16-bit integers. A value with the exponent e is the integer nearest to value * 2^e.
struct FixedPoint {
  /// Of each parameter. Size p.
  std::vector<int> theta_exponent;
  /// Of each input. Size m.
  std::vector<int> u_exponent;
  /// Of distances and of the tolerance.
  int plane_exponent = 0;
  /// The sum of each row of a law is divided by 2 to this power, 1 .. kMostShift.
  std::vector<std::uint32_t> law_shift;
};

/// The constants c of planes and k of laws count 2 to these powers. Processors of 8 bits shift by 16 at no cost.
constexpr int kPlaneUnit = 16;
constexpr int kLawUnit = 15;
constexpr int kMostShift = 24;

/// Fills in box, planes, laws, tolerance and scales as integers. No sum of the code exceeds 32 bits for a
/// parameter in the box. The tolerance is `errors` times the greatest error of a plane's value. Throws Error where a law
/// or plane needs more bits.
void fillFixedPoint(const RegionMap& map, const std::vector<double>& box, double errors, CodeTables& tables);

}  // namespace polyfly
