#pragma once

#include "mpc_core/mpc_problem.hpp"
#include "mpc_core/observer.hpp"

namespace polyfly {

/// What a model leaves out in proportion to a signal r that is known: the disturbance is w - c r. An observer estimates w,
/// this class c.
///
/// The observer is linear. So the derivatives of its estimates by c are those of an observer of the same gain, driven
/// by -r and with measurements 0. With the innovation's derivative, c follows by recursive least squares. Each change
/// of c moves the observer's estimates along their derivatives (Friedland's separation of a bias). c begins at 0 with
/// a given standard deviation and stays within three of them. Where nothing confirms it, its variance
/// grows back in kForgetTime, and c decays to 0 in that time over the variance's share of the greatest.
///
/// Gusts last longer than a period, so that their innovations are not white. What counts as noise is the innovation's
/// slow variance where that exceeds the observer's. So gusts teach little, and no error of tracking stops the learning.
///
/// The signal should be a reference: one that is measured has noise in common with the innovation, which would count for
/// c. Where the reference rests nothing is learnt, whatever pushes the vehicle.
class CoefficientEstimate {
 public:
  static constexpr double kForgetTime = 100.0;  ///< [s]

  /// For an observer of this problem and options. `state` is the one whose innovation counts, `deviation` the standard
  /// deviation of c, above 0. Throws Error as the observer does.
  CoefficientEstimate(const MpcProblem& problem, const ObserverOptions& options, int state, double deviation);

  double value() const noexcept { return value_; }  ///< c

  /// After the update of `observer` over as many periods, in which `signal` was r. The observer has to know -c r too.
  void update(DisturbanceObserver& observer, double signal, int periods) noexcept;

  void reset() noexcept;
  /// Begins with the coefficient of `other` and what its model has `more`. Another model makes it as uncertain as at the
  /// beginning.
  void transferState(const CoefficientEstimate& other, double more) noexcept;

 private:
  DisturbanceObserver derivative_;
  // Times of the innovation's low pass, and of the mean of its square [s].
  static constexpr double kSlowTime = 1.0;
  static constexpr double kVarianceTime = 5.0;
  double within(double value) const noexcept;
  void watch(double innovation, double duration) noexcept;

  int state_;
  double period_;  // [s]
  double greatest_variance_;
  double variance_;
  double value_ = 0.0;
  // The innovation behind the low pass, and the variance of white noise that would leave as much there.
  double slow_ = 0.0;
  double slow_variance_ = 0.0;
};

}  // namespace polyfly
