#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/excitation.hpp"
#include "identification/fit_loop.hpp"
#include "identification/frequency_response.hpp"
#include "identification/loop_record.hpp"

namespace polyfly {

/// One inner loop of the vehicle, with all that was recorded of it.
struct AxisRecords {
  std::string axis;          ///< roll, pitch, yaw_rate, thrust
  std::string unit;          ///< of the response: rad, rad/s, m/s^2
  std::string command_unit;  ///< rad, rad/s; of thrust whatever was logged
  LoopRecord training;
  std::optional<LoopRecord> validation;
  /// Command of the axis that would answer if frames were wrong, in the same flight.
  std::optional<TimeSeries> other_command;
  std::optional<TimeSeries> vertical_velocity;  ///< of thrust, same flight [m/s], up
  CleaningCounts cleaning;
};

struct IdentifyOptions {
  std::vector<TimeWindow> windows;             ///< used as they are; empty: chooseExcitation
  std::vector<TimeWindow> validation_windows;  ///< of the validation record; empty: chooseExcitation
  ExcitationSearchOptions excitation;
  FitOptions fit;             ///< bounds; order and with_delay are set for each model
  bool second_order = false;  ///< fit that too
};

/// How well a model does on data that it was not fitted to.
struct AxisValidationFit {
  std::string source;
  double training_percent = 0.0;
  double validation_percent = 0.0;
  bool by_halves = false;  ///< the model of the first half of the data on the second half
  std::vector<LoopSegment> segments;
  std::vector<std::vector<double>> prediction;  ///< of each segment
};

struct AxisModel {
  std::string axis;
  std::string unit;
  std::string command_unit;
  std::string source;
  double smoothing = 0.0;  ///< [s]
  CleaningCounts cleaning;
  ExcitationChoice choice;
  LoopRecord record;
  std::vector<LoopSegment> segments;
  LoopFit with_delay;                   ///< first order, Eq. 37 and a delay
  LoopFit without_delay;                ///< first order, Eq. 37 as it stands
  std::optional<LoopFit> second_order;  ///< Eq. 45 and a delay
  std::optional<AxisValidationFit> validation;
  std::vector<FrequencyPoint> frequency_response;
  std::vector<std::string> warnings;  ///< sentences: what the data do not support
  bool supported = true;  ///< the model explains the response, and gain and lag are bounded by the data
};

/// Cleans, chooses windows, fits all models, validates and warns. Throws Error naming source, axis and rule
/// when there is nothing to fit to.
AxisModel identifyAxis(const AxisRecords& records, const IdentifyOptions& options);

}  // namespace polyfly
