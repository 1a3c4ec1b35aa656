#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "online_controller/laws/multirotor_controller.hpp"
#include "polyfly_test/multirotor_plant.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly_test {

/// The flights of Sect. 3.3.3.
enum class AslquadFigure {
  kHelix,   ///< Fig. 10: along a helix, turbulent wind from one side
  kHit,     ///< Fig. 11: hover with a slung load that is hit at t = 3 s
  kSquare,  ///< Fig. 12: a square, ten times, with the load
  kStep,    ///< Fig. 13: a step of 1.25 m to the side, with the load
};

/// Who flies, all with the same model, weights, input bounds and sampling time.
enum class AslquadLaw {
  /// Minimum-peak robust MPC, explicit.
  kRobust,
  /// Linear MPC, N = 20, without knowledge of the disturbance.
  kNominal,
  /// LQR cut to the input's bounds: the linear MPC with N = 1.
  kLqr,
  /// Linear MPC with the observer of Eq. 5 and 6.
  kDisturbanceEstimate,
};

constexpr std::array<AslquadFigure, 4> kAslquadFigures{AslquadFigure::kHelix, AslquadFigure::kHit,
                                                       AslquadFigure::kSquare, AslquadFigure::kStep};
constexpr std::array<AslquadLaw, 4> kAslquadLaws{AslquadLaw::kRobust, AslquadLaw::kNominal, AslquadLaw::kLqr,
                                                 AslquadLaw::kDisturbanceEstimate};

const char* figureName(AslquadFigure figure);  ///< `helix`, `hit`, `square`, `step`
const char* lawName(AslquadLaw law);           ///< `robust`, `nominal`, `lqr`, `estimate`

/// What is tracked at `time` [s] after the start, and for how long.
polyfly::Reference figureReference(AslquadFigure figure, double time);
double figureDuration(AslquadFigure figure);  ///< [s]

constexpr double kHitTime = 3.0;      ///< [s]
constexpr double kStepLength = 1.25;  ///< [m]
constexpr double kSquareLap = 18.0;   ///< [s]
constexpr int kSquareLaps = 10;
/// Time from which on the helix is at full speed [s].
constexpr double kHelixJoined = 4.0;

/// The vehicle and what disturbs it. Unknown to the laws: thrust lag, delay, sensor noise, drag and what the
/// air does, and how the load moves. What hangs on the vehicle is known to be that heavy.
polyfly::PlantOptions figurePlant(AslquadFigure figure, int seed);

struct AslquadSample {
  double time = 0.0;
  polyfly::Reference reference;
  polyfly::PlantState truth;
  polyfly::VehicleState measured;
  Eigen::Vector3d disturbance = Eigen::Vector3d::Zero();  ///< [m/s^2]
  polyfly::AttitudeCommand command;
  polyfly::ControlStatus status = polyfly::ControlStatus::kNoReference;
};

/// What a flight says. Errors are truth minus reference.
struct AslquadErrors {
  /// Root mean square of the position error [m].
  double rms = 0.0;
  /// Greatest length of the position error [m].
  double greatest = 0.0;
  /// Greatest position error along each axis [m].
  Eigen::Vector3d greatest_axis = Eigen::Vector3d::Zero();
  /// Last time with an error beyond 0.1 m, counted from the disturbance or the start [s].
  double settled = 0.0;
  /// Overshoot beyond the target of the step [m].
  double overshoot = 0.0;
  /// Motion away from the target of the step [m].
  double undershoot = 0.0;
  /// Greatest speed along one horizontal axis [m/s].
  double speed = 0.0;
  /// Greatest roll or pitch [rad].
  double tilt = 0.0;
  /// Root mean square change of roll and pitch commands from step to step [rad].
  double input_change = 0.0;
  /// Share of samples with both horizontal disturbances within the declared bound.
  double within = 0.0;
  /// Samples that were not kOptimal.
  int degraded = 0;
  int samples = 0;
};

/// Maps and problems of the ASLquad, solved once, and flights with them.
class AslquadFlights {
 public:
  /// `problems`: folder with aslquad_*.yaml; maps are written to `scratch`, ending in / . Throws Error.
  AslquadFlights(const std::string& problems, const std::string& scratch);

  std::vector<AslquadSample> fly(AslquadFigure figure, AslquadLaw law, int seed) const;
  AslquadErrors judge(AslquadFigure figure, const std::vector<AslquadSample>& flight) const;

  /// Maps of the robust law; what a law flies with, where the vehicle and its load are `mass` [kg].
  std::array<const polyfly::RegionMap*, 3> maps() const { return {&maps_[0], &maps_[1], &maps_[2]}; }
  polyfly::MultirotorOptions options(AslquadLaw law, double mass) const;

  double samplingTime() const { return nominal_[0].sampling_time; }  ///< [s]

 private:
  std::unique_ptr<polyfly::ControlLaw> make(AslquadLaw law, double mass) const;

  std::vector<polyfly::RegionMap> maps_;
  std::array<polyfly::MpcProblem, 3> nominal_;
  std::array<double, 2> bound_{};  // half widths of the horizontal disturbances [m/s^2]
};

}  // namespace polyfly_test
