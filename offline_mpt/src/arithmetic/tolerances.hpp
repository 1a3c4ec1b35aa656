#pragma once

/// Rounding of the number types.
namespace polyfly::tolerance {

/// Distance of 1 from the next double: twice what rounding does to one operation [relative].
constexpr double kDoubleRounding = 0x1p-52;

/// What one operation with long doubles loses, with room for one bit [relative].
constexpr double kWideRounding = 0x1p-62;

/// About what one operation with two doubles loses [relative].
constexpr double kDoubleDoubleRounding = kDoubleRounding * kDoubleRounding;

}  // namespace polyfly::tolerance
