#pragma once

#include <optional>

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
/// grows back in kForgetTime, and c decays to 0 in that time over the square of the variance's share of the greatest.
/// Where c is confirmed, the decay moves it by at most the cube of that share.
///
/// The signal should be a reference: one that is measured has noise in common with the innovation, which would count for
/// c. Where the reference rests nothing is learnt, whatever pushes the vehicle.
class CoefficientEstimate {
 public:
  static constexpr double kForgetTime = 100.0;  ///< [s]
  static constexpr double kLostTime = 5.0;      ///< [s]

  /// For an observer of this problem and options. `state` is the one whose innovation counts, `deviation` the standard
  /// deviation of c, above 0. Throws Error as the observer does.
  CoefficientEstimate(const MpcProblem& problem, const ObserverOptions& options, int state, double deviation);

  double value() const noexcept { return value_; }  ///< c

  /// After the update of `observer` over as many periods, in which `signal` was r. The observer has to know -c r too.
  /// Without a signal, because the vehicle does not follow it, c decays to 0 in kLostTime.
  void update(DisturbanceObserver& observer, std::optional<double> signal, int periods) noexcept;

  void reset() noexcept;
  /// Begins with the coefficient of `other` and what its model has `more`. Another model makes it as uncertain as at the
  /// beginning.
  void transferState(const CoefficientEstimate& other, double more) noexcept;

 private:
  DisturbanceObserver derivative_;
  double within(double value) const noexcept;

  int state_;
  double period_;  // [s]
  double greatest_variance_;
  double variance_;
  double value_ = 0.0;
};

}  // namespace polyfly
