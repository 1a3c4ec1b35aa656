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
/// Noise of the innovations is what no constant c explains of them, behind a low pass. Gusts last longer than a period, and
/// would teach as much as that many samples. It is measured from the innovations that c = 0 would leave. So
/// neither a wrong model nor what is found meanwhile counts as noise.
///
/// The signal should be a reference: one that is measured has noise in common with the innovation, which would count for
/// c. Where the reference rests nothing is learnt, whatever pushes the vehicle.
class CoefficientEstimate {
 public:
  static constexpr double kForgetTime = 150.0;  ///< [s]
  static constexpr double kLostTime = 3.0;      ///< [s]

  /// For an observer of this problem and options. `state` is the one whose innovation counts, `deviation` the standard
  /// deviation of c, above 0. `first_noise` is the variance with which the record begins, over that of the options.
  /// Throws Error as the observer does.
  CoefficientEstimate(const MpcProblem& problem, const ObserverOptions& options, int state, double deviation,
                      double first_noise = 1.0);

  double value() const noexcept { return value_; }  ///< c

  /// After the update of `observer` over as many periods, in which `signal` was r. The observer has to know -c r too.
  /// Without a signal, because the vehicle does not follow it, nothing is learnt but the noise, and c decays to 0 in
  /// kLostTime.
  void update(DisturbanceObserver& observer, std::optional<double> signal, int periods) noexcept;

  void reset() noexcept;
  /// Begins with the coefficient of `other` and what its model has `more`. Another model makes it as uncertain as at the
  /// beginning.
  void transferState(const CoefficientEstimate& other, double more) noexcept;

 private:
  /// What the low pass leaves of the innovation that c = 0 would leave and of its derivative by c, and the means of the
  /// products of both over the last seconds, scaled to white noise.
  struct Record {
    double innovation = 0.0, slope = 0.0;
    double innovation_square = 0.0, product = 0.0, slope_square = 0.0;
  };

  DisturbanceObserver derivative_;
  double within(double value) const noexcept;
  Record freshRecord() const noexcept;
  void record(double innovation, double slope, double duration) noexcept;
  double noise() const noexcept;

  int state_;
  double period_;  // [s]
  double greatest_variance_;
  double variance_;
  double first_noise_;
  double value_ = 0.0;
  Record record_;
};

}  // namespace polyfly
