#pragma once

#include <Eigen/Core>
#include <vector>

#include "online_controller/laws/law_switch.hpp"
#include "polyfly_test/flight_figure.hpp"
#include "polyfly_test/multirotor_plant.hpp"

namespace polyfly {

/// A law's flight along the figure on the plant, hovering at first at the figure's start:
///
///     while (!flight.over()) {
///       flight.measure();
///       law.step(flight.state(), flight.preview());
///       law.prepare();
///       flight.advance(law.report().command);
///     }
class LawFlight {
 public:
  /// Looks ahead as far as `law` does, a ControlLaw or a LawSwitch. `offset` [m] of the start from the figure's.
  /// `figure` must outlive this.
  template <class AnyLaw>
  LawFlight(const FlightFigure& figure, const PlantOptions& plant, const AnyLaw& law,
            const Eigen::Vector3d& offset = Eigen::Vector3d::Zero())
      : LawFlight(figure, plant, LawTiming{law.previewLength(), law.previewPeriod()}, offset, leadOf(law)) {}
  /// The references begin `lead` [s] after the odometry.
  LawFlight(const FlightFigure& figure, const PlantOptions& plant, const LawTiming& preview,
            const Eigen::Vector3d& offset, double lead = 0.0);

  /// Takes the next odometry and the references from its stamp on.
  void measure();
  /// Flies one period with the command.
  void advance(const AttitudeCommand& command) { plant_.advance(command); }

  /// Last odometry. Tests of faulty odometry change it.
  VehicleState& state() { return state_; }
  const Reference* preview() const { return preview_.data(); }

  double time() const { return plant_.time(); }  ///< [s]
  /// Whether the figure has come to its end.
  bool over() const;
  /// True distance from the figure [m].
  double error() const;
  const MultirotorPlant& plant() const { return plant_; }

 private:
  static double leadOf(const ControlLaw&) { return 0.0; }
  static double leadOf(const LawSwitch& law) { return law.lead(); }

  const FlightFigure& figure_;
  MultirotorPlant plant_;
  double preview_period_ = 0.0;
  double lead_ = 0.0;
  std::vector<Reference> preview_;
  VehicleState state_;
};

}  // namespace polyfly
