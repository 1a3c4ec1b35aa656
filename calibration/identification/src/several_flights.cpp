#include "identification/several_flights.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <utility>

#include "axis_stages.hpp"
#include "diagnose.hpp"
#include "identification/random_effects.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Pause between flights that are put on one clock; more than a far step, so that nothing spans it [s].
constexpr double kPauseBetween = kFarStep + 10.0;
// From half an interval to the standard error that it stands for.
constexpr double kIntervalFactor = 1.959964;
// Spread between flights above which one model does not describe them, relative to the value.
constexpr double kGreatSpread = 0.2;
// Greatest drop of the fit from a flight's own model to that of the others [%].
constexpr double kDropBetween = 8.0;

struct IdentifiedFlight {
  AxisModel model;
  AxisRecords records;
  IdentifyOptions options;
  // From the flight's own time to that of all flights [s].
  double shift = 0.0;
  // Where the record begins on the clock of all flights [s].
  double begins = 0.0;
};

TimeWindow shifted(TimeWindow window, double by) { return {window.from + by, window.to + by}; }

void append(const TimeSeries& series, double shift, TimeSeries* all) {
  for (const double time : series.time) all->time.push_back(time + shift);
  all->value.insert(all->value.end(), series.value.begin(), series.value.end());
}

void append(const std::vector<RejectedWindow>& windows, double shift, std::vector<RejectedWindow>* all) {
  for (const RejectedWindow& one : windows) all->push_back({shifted(one.window, shift), one.reason});
}

// A flight after the other on one clock, from 0 s on.
void layOut(std::vector<IdentifiedFlight>* flights) {
  double next = 0.0;
  for (IdentifiedFlight& flight : *flights) {
    const LoopRecord& record = flight.model.record;
    flight.begins = next;
    flight.shift = next - std::min(record.command.time.front(), record.response.time.front());
    next = std::max(record.command.time.back(), record.response.time.back()) + flight.shift + kPauseBetween;
  }
}

// What all flights recorded, as one record.
AxisRecords joined(const std::vector<IdentifiedFlight>& flights) {
  AxisRecords all;
  const AxisModel& first = flights.front().model;
  all.axis = first.axis;
  all.unit = first.unit;
  all.command_unit = first.command_unit;
  all.training.smoothing = first.smoothing;
  const auto every = [&flights](std::optional<TimeSeries> AxisRecords::*one) {
    return std::all_of(flights.begin(), flights.end(),
                       [one](const IdentifiedFlight& flight) { return (flight.records.*one).has_value(); });
  };
  if (every(&AxisRecords::other_command)) all.other_command.emplace();
  if (every(&AxisRecords::vertical_velocity)) all.vertical_velocity.emplace();
  for (const IdentifiedFlight& flight : flights) {
    append(flight.model.record.not_flight, flight.shift, &all.training.not_flight);
    all.training.source += (all.training.source.empty() ? "" : ", ") + flight.model.source;
    append(flight.model.record.command, flight.shift, &all.training.command);
    append(flight.model.record.response, flight.shift, &all.training.response);
    if (all.other_command) append(*flight.records.other_command, flight.shift, &*all.other_command);
    if (all.vertical_velocity)
      append(*flight.records.vertical_velocity, flight.shift, &*all.vertical_velocity);
    all.cleaning.not_finite += flight.model.cleaning.not_finite;
    all.cleaning.out_of_order += flight.model.cleaning.out_of_order;
    all.cleaning.repeated += flight.model.cleaning.repeated;
  }
  return all;
}

IdentifyOptions jointOptions(const std::vector<IdentifiedFlight>& flights, IdentifyOptions options) {
  options.windows.clear();
  for (const IdentifiedFlight& flight : flights) {
    for (const TimeWindow& window : flight.model.choice.windows)
      options.windows.push_back(shifted(window, flight.shift));
  }
  return options;
}

std::vector<LoopFit> fitsOf(const std::vector<IdentifiedFlight>& flights, LoopFit AxisModel::*fit) {
  std::vector<LoopFit> fits;
  for (const IdentifiedFlight& flight : flights) fits.push_back(flight.model.*fit);
  return fits;
}

// One of the models for a controller, as each flight has it.
std::vector<LoopFit> controllerFits(const std::vector<IdentifiedFlight>& flights, std::size_t place) {
  std::vector<LoopFit> fits;
  for (const IdentifiedFlight& flight : flights) fits.push_back(flight.model.controller_models[place].fit);
  return fits;
}

// The pooled model in place of that of all flights together, with its own predictions.
void pool(const std::vector<LoopFit>& flights, const std::vector<LoopSegment>& segments, LoopFit* fit) {
  *fit = poolFits(std::move(*fit), flights);
  LoopPrediction prediction = predictLoop(*fit, segments);
  fit->fit_percent = prediction.fit_percent;
  fit->residual_rms = prediction.residual_rms;
  fit->prediction = std::move(prediction.prediction);
}

// A model on each flight that is made from the other flights. `fits` are those of each flight, `percents` takes the
// fit on each.
AxisValidationFit leaveOneOut(const std::vector<IdentifiedFlight>& flights, const std::vector<LoopFit>& fits,
                              std::vector<double>* percents) {
  AxisValidationFit result;
  result.source = "each flight";
  result.by_flights = true;
  double squares = 0.0;
  std::vector<double> response;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    std::vector<LoopFit> others = fits;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const LoopFit model = others.size() > 1 ? poolFits(others.front(), others) : others.front();
    LoopPrediction prediction = predictLoop(model, flights[i].model.segments);
    percents->push_back(prediction.fit_percent);
    for (std::size_t k = 0; k < prediction.prediction.size(); ++k) {
      LoopSegment segment = flights[i].model.segments[k];
      for (std::size_t sample = 0; sample < segment.response.size(); ++sample) {
        const double error = segment.response[sample] - prediction.prediction[k][sample];
        squares += error * error;
      }
      response.insert(response.end(), segment.response.begin(), segment.response.end());
      for (double& time : segment.time) time += flights[i].shift;
      for (double& time : segment.command.time) time += flights[i].shift;
      result.segments.push_back(std::move(segment));
      result.prediction.push_back(std::move(prediction.prediction[k]));
    }
  }
  const Eigen::Map<const Eigen::ArrayXd> values(response.data(), static_cast<Eigen::Index>(response.size()));
  result.validation_percent = 100.0 * (1.0 - std::sqrt(squares) / (values - values.mean()).matrix().norm());
  return result;
}

std::string fileName(const std::string& path) { return std::filesystem::path(path).filename().string(); }

std::string valuesOf(const std::vector<AxisFlight>& flights, std::size_t parameter) {
  std::string text;
  for (const AxisFlight& flight : flights) {
    char value[32];
    std::snprintf(value, sizeof value, "%.3g", flight.parameters[parameter].value);
    text += (text.empty() ? "" : ", ") + std::string(value);
  }
  return text;
}

void addWarnings(const std::vector<IdentifiedFlight>& flights, AxisModel* model) {
  for (const IdentifiedFlight& flight : flights) {
    for (const std::string& warning : flight.model.warnings)
      model->warnings.push_back(fileName(flight.model.source) + " alone: " + warning);
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const FittedParameter& one = model->with_delay.parameters[i];
    if (one.between_flights > kGreatSpread * std::abs(one.value)) {
      model->warnings.push_back("The flights differ in " + one.name + ": " + valuesOf(model->flights, i) +
                                ". Load, battery or wind were not the same, or it is not one vehicle.");
    }
  }
  const auto holds_zero = [model](std::size_t i) { return !(model->with_delay.parameters[i].least() > 0.0); };
  if (flights.size() == 2 && (holds_zero(0) || holds_zero(1))) {
    model->warnings.emplace_back(
        "Two flights say little of how much flights differ: the interval of gain or lag holds zero. Add a "
        "third flight.");
  }
  for (const AxisFlight& flight : model->flights) {
    if (flight.validation_percent >= flight.fit_percent - kDropBetween) continue;
    char text[160];
    std::snprintf(text, sizeof text, ": the model of the other flights reaches %.1f %%, its own %.1f %%.",
                  flight.validation_percent, flight.fit_percent);
    model->warnings.push_back(fileName(flight.source) + text);
  }
}

// What each flight says, and what was left out of it. `percents`: fit of the others' model on each.
void addFlights(const std::vector<IdentifiedFlight>& flights, const std::vector<double>& percents,
                AxisModel* model) {
  for (std::size_t i = 0; i < flights.size(); ++i) {
    const AxisModel& own = flights[i].model;
    model->flights.push_back({own.source, flights[i].begins, own.choice.windows, own.choice.rejected,
                              own.with_delay.parameters, own.with_delay.fit_percent, percents[i]});
    append(own.choice.rejected, flights[i].shift, &model->choice.rejected);
  }
}

// Validates each model for a controller flight by flight. The result is the fit of `model` on each flight, by the
// model of the others.
std::vector<double> validateByFlights(const std::vector<IdentifiedFlight>& flights, AxisModel* model) {
  std::vector<double> of_first;
  for (std::size_t i = 0; i < model->controller_models.size(); ++i) {
    std::vector<double> percents;
    AxisValidationFit each = leaveOneOut(flights, controllerFits(flights, i), &percents);
    if (i == 0) of_first = std::move(percents);
    ControllerModel& one = model->controller_models[i];
    // One that another flight has validated stays so.
    if (one.validation && !one.validation->by_halves) continue;
    each.training_percent = one.fit.fit_percent;
    one.validation = std::move(each);
  }
  model->validation = model->controller_models.front().validation;
  return of_first;
}

// The pooled models in place of those of all flights together.
void poolModels(const std::vector<IdentifiedFlight>& flights, AxisModel* model) {
  pool(fitsOf(flights, &AxisModel::without_delay), model->segments, &model->without_delay);
  for (std::size_t i = 0; i < model->controller_models.size(); ++i) {
    ControllerModel& one = model->controller_models[i];
    pool(controllerFits(flights, i), model->segments, &one.fit);
    one.validation->training_percent = one.fit.fit_percent;
    if (one.validation->by_flights) continue;
    LoopPrediction prediction = predictLoop(one.fit, one.validation->segments);
    one.validation->validation_percent = prediction.fit_percent;
    one.validation->prediction = std::move(prediction.prediction);
  }
  model->with_delay = model->controller_models.front().fit;
  if (model->second_order) model->second_order = model->findModel("model_second_order")->fit;
  model->validation = model->controller_models.front().validation;
}

AxisModel pooledModel(std::vector<IdentifiedFlight> flights, const IdentifyOptions& options,
                      const std::optional<LoopRecord>& validation) {
  layOut(&flights);
  AxisRecords records = joined(flights);
  records.validation = validation;
  const IdentifyOptions joint = jointOptions(flights, options);
  AxisModel model = chooseWindows(records, joint);
  fitAxis(records, joint, &model);
  addFlights(flights, validateByFlights(flights, &model), &model);
  FitOptions bounds = options.fit;
  bounds.order = LoopOrder::kFirst;
  bounds.with_delay = true;
  for (const IdentifiedFlight& flight : flights) model.lead = std::max(model.lead, flight.model.lead);
  model.warnings = diagnose(model, records, bounds);
  poolModels(flights, &model);
  addWarnings(flights, &model);
  judgeModels(bounds, &model);
  return model;
}

}  // namespace

std::vector<FittedParameter> poolParameters(const std::vector<std::vector<FittedParameter>>& flights) {
  std::vector<FittedParameter> pooled = flights.front();
  for (std::size_t i = 0; i < pooled.size(); ++i) {
    std::vector<FlightValue> values;
    for (const auto& flight : flights)
      values.push_back({flight[i].value, flight[i].half_width / kIntervalFactor});
    const PooledValue found = poolFlights(values);
    pooled[i].value = found.value;
    pooled[i].standard_error = found.standard_error;
    pooled[i].half_width = found.half_width;
    pooled[i].between_flights = found.between_flights;
    pooled[i].supported =
        std::all_of(flights.begin(), flights.end(), [i](const auto& flight) { return flight[i].supported; });
  }
  return pooled;
}

LoopFit poolFits(LoopFit fit, const std::vector<LoopFit>& flights) {
  std::vector<std::vector<FittedParameter>> parameters;
  for (const LoopFit& flight : flights) parameters.push_back(flight.parameters);
  fit.parameters = poolParameters(parameters);
  if (fit.shape.order == LoopOrder::kFirst) {
    fit.gain = fit.find("gain")->value;
    fit.shape.tau = fit.find("tau")->value;
  } else {
    fit.gain = fit.find("b0")->value / fit.find("a0")->value;
    fit.shape.omega = std::sqrt(fit.find("a0")->value);
    fit.shape.zeta = 0.5 * fit.find("a1")->value / fit.shape.omega;
  }
  fit.offset = fit.find("offset")->value;
  if (const FittedParameter* delay = fit.find("delay")) fit.shape.delay = delay->value;
  return fit;
}

AxisModel identifyFlights(const std::vector<AxisFlightRecords>& flights, const IdentifyOptions& options) {
  std::vector<std::string> left_out;
  std::optional<LoopRecord> validation;
  std::vector<IdentifiedFlight> chosen;
  for (const AxisFlightRecords& flight : flights) {
    if (flight.records.validation) validation = flight.records.validation;
    IdentifyOptions own = options;
    own.windows = flight.windows;
    try {
      chosen.push_back({chooseWindows(flight.records, own), flight.records, own});
    } catch (const Error& error) {
      left_out.emplace_back(error.what());
    }
  }
  std::vector<IdentifiedFlight> identified;
  for (IdentifiedFlight& flight : chosen) {
    try {
      fitAxis(flight.records, flight.options, &flight.model);
      identified.push_back(std::move(flight));
    } catch (const Error& error) {
      left_out.emplace_back(error.what());
    }
  }
  if (identified.empty()) throw Error(left_out.front());
  AxisModel model;
  if (identified.size() > 1)
    model = pooledModel(std::move(identified), options, validation);
  else
    model = std::move(identified.front().model);
  for (const std::string& sentence : left_out) model.warnings.push_back("Left out: " + sentence);
  return model;
}

}  // namespace polyfly
