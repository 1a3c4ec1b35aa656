#include "polyfly_test/law_flight.hpp"

namespace polyfly {
namespace {

// Rounding error of the simulated time [s].
constexpr double kRounding = 1e-9;

PlantState hovering(const FlightFigure& figure, double gravity, const Eigen::Vector3d& offset) {
  const Reference first = figure.at(0.0);
  PlantState state;
  state.position = first.position + offset;
  state.yaw = first.yaw;
  state.thrust = gravity;
  return state;
}

}  // namespace

LawFlight::LawFlight(const FlightFigure& figure, const PlantOptions& plant, const LawTiming& preview,
                     const Eigen::Vector3d& offset, double lead)
    : figure_(figure),
      plant_(plant, hovering(figure, plant.gravity, offset)),
      preview_period_(preview.preview_period),
      lead_(lead),
      preview_(static_cast<std::size_t>(preview.preview_length)) {}

void LawFlight::measure() {
  state_ = plant_.measure();
  for (std::size_t k = 0; k < preview_.size(); ++k) {
    preview_[k] = figure_.at(state_.stamp + lead_ + static_cast<double>(k) * preview_period_);
  }
}

bool LawFlight::over() const { return plant_.time() >= figure_.duration() - kRounding; }

double LawFlight::error() const {
  return (plant_.state().position - figure_.at(plant_.time()).position).norm();
}

}  // namespace polyfly
