#pragma once

/// Tolerances of soft bounds.
namespace polyfly::tolerance {

/// A smaller slack is rounding of 0 [greatest bound].
constexpr double kNoExcess = 1e-9;

/// By how much a multiplier may exceed the weight through rounding [weight].
constexpr double kWeightTolerance = 1e-9;

/// The equations of an active set with a greater one are independent [reciprocal of the condition].
constexpr double kIndependentEquations = 1e-12;

}  // namespace polyfly::tolerance
