#pragma once

#include <Eigen/Core>
#include <vector>

#include "thrust_samples.hpp"

namespace polyfly {

/// Polynomial command over thrust, given by its values at evenly spaced thrusts. Behind the samples it goes on as a
/// straight line.
class CurveShape {
 public:
  /// The first and the last thrust, and how far a sample lies from the middle between them at most.
  CurveShape(int degree, double least, double greatest, double farthest);

  int degree() const { return static_cast<int>(thrusts_.size()) - 1; }
  double least() const { return thrusts_.front(); }
  double greatest() const { return thrusts_.back(); }
  const std::vector<double>& thrusts() const { return thrusts_; }

  /// Command and slope at a thrust are these rows times the values.
  Eigen::RowVectorXd valueRow(double thrust) const;
  Eigen::RowVectorXd slopeRow(double thrust) const;
  /// The coefficient of the highest power, by a positive factor.
  Eigen::RowVectorXd highestRow() const;

  /// Whether the curve of these values rises wherever it is used.
  bool rises(const Eigen::VectorXd& values) const;
  /// Thrust of a command. The curve must rise.
  double thrustOf(double command, const Eigen::VectorXd& values) const;
  /// Coefficients of 1, F, F^2 ...
  std::vector<double> coefficients(const Eigen::VectorXd& values) const;

 private:
  double scaled(double thrust) const { return (thrust - middle_) / half_; }

  std::vector<double> thrusts_;
  double middle_;
  double half_;
  // Where the straight lines begin, as scaled thrust.
  double end_;
  // From the values to the coefficients of powers of the scaled thrust.
  Eigen::MatrixXd powers_;
};

/// The unknowns of a thrust model and how well they are known.
struct ThrustModel {
  /// Commands at the thrusts of the shape.
  Eigen::VectorXd values;
  double battery = 0.0;     ///< exponent of the voltage, or drift
  double climb_drag = 0.0;  ///< [1/s]
  /// Of values, battery and climb_drag, as far as they are unknowns. Empty until findCovariance.
  Eigen::MatrixXd covariance;
  /// From a standard error to half of the 95 % interval.
  double interval_factor = 0.0;
  /// False: the data pull the curve to where it does not rise.
  bool rises = true;

  Eigen::VectorXd predict(const CurveShape& shape, const ThrustSamples& samples) const;
};

/// Least loss of Huber in the thrust. Throws Error without a name where the thrust does not rise with the command.
ThrustModel fitThrustModel(const CurveShape& shape, const ThrustSamples& samples);

/// Fills covariance and interval_factor of a model that was fitted to these samples.
void findCovariance(const CurveShape& shape, const ThrustSamples& samples, ThrustModel* model);

/// Residual mean square of the thrust after a quadratic polynomial in the command and all else that is linear, and
/// what that models of it without the climb.
struct CommandRegression {
  double mean_square = 0.0;
  Eigen::VectorXd modelled;
};
CommandRegression regressOnCommand(const ThrustSamples& samples);

}  // namespace polyfly
