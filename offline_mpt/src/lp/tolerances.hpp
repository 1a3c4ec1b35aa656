#pragma once

/// Tolerances of the floating linear programs.
namespace polyfly::tolerance {

/// Coefficients of a dictionary below this do not count as a direction [unit rows].
constexpr double kPivot = 1e-10;

/// Where rounding takes the vertex of a dictionary further from its rows, its answer does not count [unit rows].
constexpr double kDrift = 1e-11;

/// Points that violate one row only, to show that it is needed, lie at most so far beyond it [unit rows].
constexpr double kMostBeyond = 1.0;

/// Rows whose steps differ by less block at the same step [step lengths].
constexpr double kRatioTie = 1e-14;

/// The largest ball is found exactly if its radius is at least minus this [unit rows].
constexpr double kHopelessRadius = 1e-6;

/// Slacks may be negative by so much [unit rows].
constexpr double kNegativeSlack = 1e-12;

/// Difference of two ways to find one radius, above which both are in doubt [unit rows].
constexpr double kSameRadius = 1e-9;

/// Shorter steps count as degenerate [unit rows].
constexpr double kDegenerateStep = 1e-13;

/// Violation from which on a row enters the basis [unit rows].
constexpr double kEnteringViolation = 1e-13;

/// Rows with weights below this do not leave the basis [unit rows].
constexpr double kLeavingWeight = 1e-11;

}  // namespace polyfly::tolerance
