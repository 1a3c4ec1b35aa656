#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "helix.hpp"
#include "online_controller/laws/multirotor_controller.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"
#include "project_root.hpp"

namespace polyfly {

inline constexpr double kPeriod = 0.01;  // [s]

using Pilot = std::function<AttitudeCommand(const VehicleState&, const Path&)>;

inline Pilot pilotOf(const std::shared_ptr<ControlLaw>& law) {
  return [law](const VehicleState& state, const Path& path) {
    std::vector<Reference> preview(static_cast<std::size_t>(law->previewLength()));
    for (std::size_t k = 0; k < preview.size(); ++k)
      preview[k] = path(state.stamp + static_cast<double>(k) * law->previewPeriod());
    const AttitudeCommand command = law->step(state, preview.data()).command;
    law->prepare();
    return command;
  };
}

/// Numbers of Eq. 37 for roll and pitch alike.
struct Model {
  double gain, lag, drag;  // [1], [s], [1/s]
};

/// The shipped problem of an axis, with these numbers if any.
inline MpcProblem problemWith(const char* axis, const Model* model) {
  MpcProblem problem = loadProblem(problemFile(std::string("multirotor_") + axis + ".yaml"));
  if (model == nullptr || problem.stateCount() != 3) return problem;
  problem.A_c(1, 1) = -model->drag;
  problem.A_c(2, 2) = -1.0 / model->lag;
  problem.B_c(2, 0) = model->gain / model->lag;
  return problem;
}

/// The three axes' problems, longitudinal first.
inline std::array<MpcProblem, 3> problemsWith(const Model* model) {
  return {problemWith("longitudinal", model), problemWith("lateral", model), problemWith("vertical", model)};
}

// A drift of the disturbance's rate that follows what turns with the path [m/s^3].
inline constexpr double kRateDrift = 0.03;

/// The defaults, without what the laws find of their model's errors, and with a rate of the disturbance instead.
enum class Estimates { kDefault, kConstant, kRate };

inline MultirotorOptions optionsOf(Estimates estimates) {
  MultirotorOptions options;
  if (estimates == Estimates::kDefault) return options;
  options.adapt_model = false;
  if (estimates == Estimates::kRate) options.disturbance_rate_drift = kRateDrift;
  return options;
}

/// Without look-ahead its commands are those of explicit_linear within 1e-6 (laws_test).
inline Pilot linearPilot(bool look_ahead, const Model* model, Estimates estimates) {
  MultirotorOptions options = optionsOf(estimates);
  options.look_ahead = look_ahead;
  return pilotOf(std::make_shared<MultirotorController>(problemsWith(model), options));
}

inline Pilot nonlinearPilot(const Model* model, Estimates estimates) {
  NonlinearMpcOptions options;
  if (model != nullptr) {
    options.model.roll_gain = options.model.pitch_gain = model->gain;
    options.model.roll_time = options.model.pitch_time = model->lag;
    options.model.drag.head<2>().setConstant(model->drag);
  }
  return pilotOf(std::make_shared<NonlinearController>(optionsOf(estimates), options));
}

}  // namespace polyfly
