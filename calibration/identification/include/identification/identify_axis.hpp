#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/excitation.hpp"
#include "identification/fit_loop.hpp"
#include "identification/loop_record.hpp"
#include "identification/model_support.hpp"

namespace polyfly {

/// One inner loop of the vehicle, with all that was recorded of it.
struct AxisRecords {
  /// Name of the loop: roll, pitch, yaw_rate or thrust.
  std::string axis;
  /// Unit of the response: rad, rad/s or m/s^2.
  std::string unit;
  /// Unit of the command: rad or rad/s. For thrust it is the logged unit.
  std::string command_unit;
  /// Clauses on the options that take command or response for another unit.
  std::string command_help;
  std::string response_help;
  LoopRecord training;
  std::optional<LoopRecord> validation;
  /// Command of the axis that would answer if frames were wrong, in the same flight.
  std::optional<TimeSeries> other_command;
  /// Vertical velocity in the same flight, up positive, for the thrust loop only [m/s].
  std::optional<TimeSeries> vertical_velocity;
};

struct IdentifyOptions {
  /// Windows that are used as they are. Empty: chooseExcitation chooses them.
  std::vector<TimeWindow> windows;
  /// Bounds of the fit. Order and with_delay are set for each model.
  FitOptions fit;
  /// Whether to fit a second-order model too.
  bool second_order = false;
};

struct AxisModel {
  std::string axis;
  std::string unit;
  std::string command_unit;
  std::string source;
  ExcitationChoice choice;
  LoopRecord record;
  std::vector<LoopSegment> segments;
  /// What each flight says, if there are several: then record, choice and segments stand there only.
  std::vector<AxisModel> flights;
  /// First-order model of Eq. 37 with a delay.
  LoopFit with_delay;
  /// Validation of with_delay.
  std::optional<AxisValidationFit> validation;
  /// What controllers can be given, each with its own evaluation: of thrust only `model`.
  std::vector<ControllerModel> controller_models;
  /// Time by which the response leads its command [s]; 0 where it does not.
  double lead = 0.0;
  /// Sentences on what the data do not support.
  std::vector<std::string> warnings;
  /// Whether the model that problem files take is supported: the one without delay, of thrust the one with.
  bool supported = true;

  /// Time that was used, of all flights [s].
  double usedTime() const;
  /// Time in which the command moves: what was used, and what was left out because the response does not follow [s].
  double movingTime() const;
  /// None if there is no model with this key.
  const ControllerModel* findModel(const std::string& key) const;
};

/// Cleans, chooses windows, fits all models, validates and warns. Throws Error naming source, axis and rule
/// when there is nothing to fit to.
AxisModel identifyAxis(const AxisRecords& records, const IdentifyOptions& options);

}  // namespace polyfly
