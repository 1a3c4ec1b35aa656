#pragma once

#include <optional>
#include <string>
#include <vector>

#include "identification/fit_loop.hpp"

namespace polyfly {

/// How well a model does on data that it was not fitted to.
struct AxisValidationFit {
  std::string source;
  double training_percent = 0.0;
  double validation_percent = 0.0;
  /// True: the model of the first half of the data is validated on the second half.
  bool by_halves = false;
  /// True: each of several flights is validated with the model of the others.
  bool by_flights = false;
  std::vector<LoopSegment> segments;
  /// Predicted response of each segment.
  std::vector<std::vector<double>> prediction;
};

/// A model in the form in which a controller takes it, with its own evaluation.
struct ControllerModel {
  /// Key of the calibration file: model, model_without_delay, model_second_order or
  /// model_second_order_without_delay.
  std::string key;
  /// Name for text and page.
  std::string title;
  LoopFit fit;
  /// None where the data do not suffice for a validation.
  std::optional<AxisValidationFit> validation;
  /// Sentences on why no controller may be given this model.
  std::vector<std::string> reasons;

  bool supported() const { return reasons.empty(); }
};

/// Least fit of a model that is given to a controller [%].
constexpr double kLeastFit = 60.0;
/// Least fit of such a model on data that it was not fitted to [%].
constexpr double kLeastValidation = 50.0;

/// The first-order lag without delay that stands for a lag with a delay: the same gain, and tau + delay as
/// time constant. Its phase is that of the loop at low frequencies, where a controller works. The least-squares
/// lag without delay has too great a gain and lag instead. Fit and prediction are those of this model on the
/// segments; intervals follow from those of `with_delay`.
LoopFit equivalentLag(const LoopFit& with_delay, const std::vector<LoopSegment>& segments);

/// Sentences on why no controller may be given this model of a loop. The reasons are a poor fit, a poor or no
/// validation, an interval that holds zero, or too little excitation. Others are a gain of another unit, and a number
/// at the end of its search range. `bounds` are those of the fit. Empty if it is supported.
std::vector<std::string> reasonsAgainst(const ControllerModel& model, const std::string& axis,
                                        const FitOptions& bounds);

}  // namespace polyfly
