#pragma once

/// Tolerances of soft bounds.
namespace polyfly::tolerance {

/// A smaller slack is rounding of 0.
constexpr double kNoExcess = 1e-9;

/// By how much a multiplier may exceed the weight through rounding.
constexpr double kWeightTolerance = 1e-9;

/// The equations of an active set with a greater one are independent.
constexpr double kIndependentEquations = 1e-12;

/// Functions on the cells of a closed loop with smaller coefficients are constants.
constexpr double kConstantFunction = 1e-12;

/// A constant function up to this is 0 there.
constexpr double kZeroFunction = 1e-9;

/// Cells of a closed loop with a smaller inscribed ball are faces of others.
constexpr double kFaceOfOthers = 1e-9;

}  // namespace polyfly::tolerance
