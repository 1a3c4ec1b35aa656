#pragma once

/// Tolerances of safety filters.
namespace polyfly::tolerance {

/// A sum of n products of doubles is off by at most n + 2 of these [sum of magnitudes].
constexpr double kSumRounding = 0x1p-52;

/// Part of the margin that the recursion in floating point may use [margin].
constexpr double kToleranceOfMargin = 1e-2;

/// A row with a smaller part in u does not depend on it [the part in xi].
constexpr double kNoInput = 1e-13;

}  // namespace polyfly::tolerance
