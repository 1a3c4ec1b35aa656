#pragma once

#include <Eigen/Core>
#include <array>

#include "mpc_core/mpc_problem.hpp"

namespace polyfly {

/// Noise of the observer's model, as standard deviations; only their ratios shape the gain. Entry i belongs
/// to state i of the problem. The defaults suit the axes of a multirotor (position, velocity, angle) at 0.01
/// s and reach 90 % of a step of wind in 1.2 s.
struct ObserverOptions {
  double period = 0.01;  ///< time between samples, above 0 [s]

  /// Error of the model in one period, 0 or more [unit of the state]
  std::array<double, 4> process = {5e-4, 5e-3, 1e-2, 1e-2};

  /// Error of the measurement, above 0 [unit of the state]
  std::array<double, 4> measurement = {0.005, 0.02, 0.01, 0.05};

  /// Drift of the disturbance in one period, above 0 [unit of the disturbance]
  double disturbance = 0.01;

  /// Drift of the disturbance's rate in one period; 0: the disturbance is constant but for its drift [unit of the
  /// disturbance per s]
  double rate = 0.0;

  /// Time in which a rate decays to 1 / e, above 0 [s]
  double rate_time = 1.0;
};

/// Observer of Eq. 5 for one axis whose whole state is measured. It estimates the constant disturbance d that the
/// model leaves unexplained. So the targets of Eq. 6 remove the offset.
///
/// The filter form is used, so that an estimate uses the sample it comes with:
///     x^- = A x + B u + Bd d,  d^- = d             (once per period)
///     [x; d] = [x^-; d^-] + L (x^- - y)            (sign of Eq. 5: predicted minus measured, hence L < 0)
/// It is Eq. 5 with the gain [A Bd; 0 I] L, its estimates taken after the correction. L is the steady-state
/// Kalman gain.
///
/// With options.rate above 0 the disturbance has a rate, d' = r, r' = -r / rate_time, which is estimated too. So a
/// disturbance that turns with the path is followed with less delay. A constant one is still estimated without offset.
class DisturbanceObserver {
 public:
  static constexpr int kMaxStates = 4;
  static constexpr int kMaxPeriods = 20;  ///< longest gap that is predicted across

  /// Needs 1 to 4 states, one input, one disturbance that shows in the state. Throws Error otherwise, or when
  /// an option is out of range.
  DisturbanceObserver(const MpcProblem& problem, const ObserverOptions& options);

  /// The sample `y` (all states, absolute) is `periods` nominal periods after the last one, during which
  /// `u_previous` was held. The first sample after reset, or one more than kMaxPeriods late, sets the state
  /// and keeps the disturbance. Values that are not finite are ignored; count their periods into the next
  /// call. A restart on the sample sets the rate to 0. `known` is a part of the disturbance that is known meanwhile.
  void update(const double* y, const double* u_previous, int periods, double known = 0.0) noexcept;

  /// Forgets the state and sets the disturbance to 0.
  void reset() noexcept;

  /// Sets the estimate of the disturbance, and its rate to 0; what is not finite is ignored.
  void setDisturbance(double disturbance) noexcept;

  /// Goes on with the estimate of another observer; one with another number of states is ignored.
  void transferState(const DisturbanceObserver& other) noexcept;

  const double* state() const noexcept { return estimate_.data(); }  ///< stateCount() entries
  double disturbance() const noexcept { return estimate_[static_cast<std::size_t>(state_count_)]; }
  /// Rate r of the disturbance, 0 without options.rate [unit of the disturbance per s]
  double rate() const noexcept { return estimate_[static_cast<std::size_t>(state_count_) + 1]; }
  int stateCount() const noexcept { return state_count_; }
  /// Predicted minus measured state of the last update; 0 after a restart on the sample.
  double innovation(int state) const noexcept { return innovation_[static_cast<std::size_t>(state)]; }
  /// Its variance where the noise is that of the options.
  double innovationVariance(int state) const noexcept {
    return innovation_variance_[static_cast<std::size_t>(state)];
  }

  /// Adds `share` times the estimates of `along`, an observer of the same problem.
  void move(double share, const DisturbanceObserver& along) noexcept;

  /// L = [L_x; L_d], (nx + 1) x nx; with options.rate a row L_r more.
  Eigen::MatrixXd gain() const;

 private:
  static constexpr int kMaxSize = kMaxStates + 2;
  using Vector = std::array<double, kMaxSize>;

  void predict(double u, double known) noexcept;
  void correct(const double* y) noexcept;

  int state_count_ = 0;
  int size_ = 0;                               ///< of what is estimated: x, d, and r with options.rate
  std::array<Vector, kMaxSize> transition_{};  ///< rows of [A Bd; 0 I], with options.rate also of r
  Vector input_{};                             ///< [B; 0]
  std::array<Vector, kMaxSize> gain_{};        ///< rows of L
  Vector estimate_{};                          ///< [x; d; r]
  Vector innovation_{};
  Vector innovation_variance_{};
  bool started_ = false;
};

}  // namespace polyfly
