#pragma once

#include <string>
#include <vector>

#include "identification/thrust_fit.hpp"
#include "thrust_model.hpp"

namespace polyfly {

/// What the judgement of a curve looks at, beside the curve itself.
struct CurveEvidence {
  const CurveShape& shape;
  /// Values of the curve at its thrusts.
  Eigen::VectorXd values;
  /// For a row r of the shape, half of the 95 % interval of r times the values is sqrt(r intervals r').
  Eigen::MatrixXd intervals;
  double weight = 0.0;  ///< mass times gravity [N]
  /// False: the data pull the curve to where it does not rise.
  bool rises = true;
  /// True: the user chose the degree.
  bool degree_given = false;
  /// Greatest deviation of an accelerometer's scale from 1.
  double accelerometer_error = 0.0;
  double climb_drag = 0.0;  ///< [1/s]
  /// Drift of the command over a flight without a voltage; nullptr: the voltage is known.
  const FittedParameter* drift = nullptr;

  double halfWidth(const Eigen::RowVectorXd& row) const;
};

/// Sentences on why no controller may be given this curve.
std::vector<std::string> reasonsAgainstCurve(const IdentifiedCurve& curve, const CurveEvidence& evidence);

/// Whether the voltage changes the command for a thrust by more than 3 % over what was flown.
bool voltageMatters(const FlownVoltage& voltage, const FittedParameter& exponent);

}  // namespace polyfly
