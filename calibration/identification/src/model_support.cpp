#include "identification/model_support.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sentence.hpp"

namespace polyfly {
namespace {

// Greatest half width of a gain's interval, relative to its value.
constexpr double kWidestGain = 0.16;
// Greatest half width of every other number's interval but the delay's, relative to its value.
constexpr double kWidestNumber = 0.5;
// Gain below which command and response have different units. They also have above its inverse.
constexpr double kGainOfOtherUnit = 0.25;
// Share of the search range from which on a number lies at its upper end.
constexpr double kUpperEnd = 0.95;
// Factor of the least value up to which a number lies at the lower end of the search range.
constexpr double kLowerEnd = 1.05;

void addFitReasons(const ControllerModel& model, std::vector<std::string>* reasons) {
  if (!(model.fit.fit_percent >= kLeastFit)) {
    reasons->push_back(sentence("The fit is %.1f %%; a controller needs at least %.0f %%.",
                                model.fit.fit_percent, kLeastFit));
  }
  if (!model.validation) {
    reasons->emplace_back(
        "The data do not suffice for a validation: both halves must excite the loop for 2 s.");
  } else if (!(model.validation->validation_percent >= kLeastValidation)) {
    reasons->push_back(
        sentence("The fit on data that it was not fitted to is %.1f %%; a controller needs at "
                 "least %.0f %%.",
                 model.validation->validation_percent, kLeastValidation));
  }
}

void addIntervalReasons(const ControllerModel& model, std::vector<std::string>* reasons) {
  for (const FittedParameter& one : model.fit.parameters) {
    if (one.name == "delay" || one.name == "offset") continue;
    if (!(one.least() > 0.0)) {
      reasons->push_back(sentence("The 95 %% interval of %s, %.3g .. %.3g, is not above zero.",
                                  one.name.c_str(), one.least(), one.greatest()));
      continue;
    }
    const double allowed = one.name == "gain" ? kWidestGain : kWidestNumber;
    if (one.half_width <= allowed * one.value) continue;
    reasons->push_back(
        sentence("Too little excitation for %s, or flights that differ: its 95 %% interval, %.3g .. %.3g, "
                 "reaches further than %.0f %% of %.3g.",
                 one.name.c_str(), one.least(), one.greatest(), 100.0 * allowed, one.value));
  }
}

void addSearchReasons(const ControllerModel& model, const FitOptions& bounds,
                      std::vector<std::string>* reasons) {
  const LoopShape& shape = model.fit.shape;
  if (shape.delay > kUpperEnd * bounds.delay_greatest) {
    reasons->push_back(sentence("The delay of %.2f s lies at the end of its search range.", shape.delay));
  }
  if (shape.order != LoopOrder::kFirst) return;
  const bool low = shape.tau < kLowerEnd * bounds.tau_least;
  if (low || shape.tau > kUpperEnd * bounds.tau_greatest) {
    reasons->push_back(
        sentence("The time constant of %.3f s lies at the end of its search range.", shape.tau));
  }
}

}  // namespace

LoopFit equivalentLag(const LoopFit& with_delay, const std::vector<LoopSegment>& segments) {
  const FittedParameter& tau = *with_delay.find("tau");
  const FittedParameter& delay = *with_delay.find("delay");
  LoopFit result = with_delay;
  result.shape.tau = tau.value + delay.value;
  result.shape.delay = 0.0;
  // A delay that was not looked for, or lies at its least value, has no error.
  const double of_delay = std::isfinite(delay.half_width) ? delay.half_width : 0.0;
  const double square =
      tau.half_width * tau.half_width + of_delay * of_delay + 2.0 * with_delay.lag_delay_square;
  const FittedParameter sum = {"tau", "s", result.shape.tau, std::sqrt(std::max(0.0, square))};
  result.parameters = {*with_delay.find("gain"), sum, *with_delay.find("offset")};
  LoopPrediction prediction = predictLoop(result, segments);
  result.fit_percent = prediction.fit_percent;
  result.prediction = std::move(prediction.prediction);
  return result;
}

std::vector<std::string> reasonsAgainst(const ControllerModel& model, const std::string& axis,
                                        const FitOptions& bounds) {
  std::vector<std::string> reasons;
  addFitReasons(model, &reasons);
  addIntervalReasons(model, &reasons);
  addSearchReasons(model, bounds, &reasons);
  const double gain = model.fit.gain;
  const bool other_unit = gain > 0.0 && (gain < kGainOfOtherUnit || gain > 1.0 / kGainOfOtherUnit);
  if (axis != "thrust" && other_unit) {
    reasons.push_back(
        sentence("The gain of %.3g is that of other units: a loop that reaches its command has about "
                 "1.",
                 gain));
  }
  return reasons;
}

}  // namespace polyfly
