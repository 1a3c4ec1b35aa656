#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "fixedwing_lateral/horizon_data.hpp"
#include "fixedwing_lateral/horizon_qp.hpp"
#include "fixedwing_lateral/model.hpp"
#include "fixedwing_lateral/roll_shooting.hpp"
#include "fixedwing_lateral/tracking_cost.hpp"
#include "fixedwing_lateral/tuning.hpp"

namespace polyfly {

struct NmpcReport {
  /// Of the quadratic program. The real-time iteration may not have converged.
  QpStatus status = QpStatus::kOptimal;
  /// Whether the moves are feasible, optimal or not. Else the nodes stay as they were.
  bool hasMoves() const noexcept {
    return status == QpStatus::kOptimal || status == QpStatus::kIterationLimit;
  }
  /// KKT measure before this iteration: largest of the projected gradient by a move and the gaps [-].
  double kkt = 0.0;
  /// Cost before this iteration: the sum of Eq. 46 at the nodes [-].
  double cost = 0.0;
  /// Number of active bounds in the last quadratic program.
  int active_bounds = 0;
};

/// Eq. 46 by the Gauss-Newton real-time iteration: direct multiple shooting with one Runge-Kutta step an
/// interval, one quadratic program an iteration (HorizonQp). Between iterations the nodes stay where they are
/// (no shift).
///
///     // Preparation, before the state arrives.
///     nmpc.prepare(data);
///     // Feedback, when the state has arrived.
///     report = nmpc.feedback(state);
///
/// All but the constructor is free of allocation and exceptions. One object serves one thread.
class LateralNmpc {
 public:
  /// Throws polyfly::Error, beginning with `where`, on options out of range.
  LateralNmpc(const LateralModel& model, const HorizonOptions& options, const std::string& where);

  int horizon() const noexcept { return N_; }
  double stepDuration() const noexcept { return step_; }
  const LateralModel& model() const noexcept { return model_; }

  /// Taken by the next `prepare`. They must pass checkTuning.
  void setTuning(const LateralWeights& weights, const LateralLimits& limits) noexcept;
  const LateralLimits& limits() const noexcept { return limits_; }

  /// Largest |e_t| at the nodes, as of the last `prepare` [m].
  double largestTrackError() const noexcept { return largest_track_error_; }

  /// Begins anew: nodes from `state` with the roll reference held, which also becomes the previous horizon.
  void reset(const HorizonData& data, const LateralState& state, double roll_reference) noexcept;

  /// The previous horizon, from which slew is counted. It has the present moves, read `steps` later (between 0 and
  /// N). Moves between two are interpolated, those past the end are the last.
  void keepAsPrevious(double steps) noexcept;

  /// After the flown segment changed, so that no node counts as switched: x_sw of all nodes becomes 0.
  void clearSwitch() noexcept;

  /// Linearises about the nodes and factorises. False where something is not finite; then `feedback` says so.
  bool prepare(const HorizonData& data) noexcept;

  /// One iteration from the state, whose heading may be off by whole turns. Needs `prepare`.
  NmpcReport feedback(const LateralState& state) noexcept;

  double* moves() noexcept { return moves_.data(); }  ///< phi_r of the intervals, N [rad]
  const double* moves() const noexcept { return moves_.data(); }
  LateralState* nodes() noexcept { return nodes_.data(); }  ///< N + 1
  const LateralState* nodes() const noexcept { return nodes_.data(); }
  double* previousMoves() noexcept { return previous_.data(); }  ///< N [rad]

  /// The quadratic program of the last `prepare`.
  const HorizonQp& program() const noexcept { return qp_; }

 private:
  void linearise(const HorizonData& data) noexcept;
  void addRoll(int k, const StageTerms& terms, double roll_bias) noexcept;
  Interval moveBound(int k) const noexcept;
  void setBounds() noexcept;
  double stationarity() noexcept;
  void takeStep() noexcept;

  LateralModel model_;
  int N_ = 0;
  double step_ = 0.0;
  RollShooting shooting_;
  LateralWeights weights_;
  LateralLimits limits_;
  // Slew weights of the moves.
  std::vector<double> slew_;
  HorizonQp qp_;
  std::vector<LateralState> nodes_;
  std::vector<double> moves_;
  std::vector<double> previous_;
  // Rise of x_sw over each interval.
  std::vector<double> switch_rise_;
  // Roll from which phi is counted [rad].
  std::vector<double> roll_along_;
  // Roll reference that holds roll_along_; phi_r is counted from it [rad].
  std::vector<double> input_along_;
  bool prepared_ = false;
  double kkt_ = 0.0;
  double cost_ = 0.0;
  double largest_track_error_ = 0.0;
};

}  // namespace polyfly
