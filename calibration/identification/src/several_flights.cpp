#include "identification/several_flights.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnose.hpp"
#include "polyfly_base/error.hpp"
#include "report/report.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

// Spread of a number between flights above which one model does not describe them, relative to the value.
constexpr double kGreatSpread = 0.4;

// The mean of one model over flights; residuals and prediction are of no flight and left empty.
LoopFit meanFit(const std::vector<LoopFit>& flights) {
  LoopFit fit;
  std::vector<std::vector<FittedParameter>> parameters;
  for (const LoopFit& flight : flights) {
    parameters.push_back(flight.parameters);
    fit.samples += flight.samples;
  }
  fit.shape = flights.front().shape;
  fit.residual_scale = flights.front().residual_scale;
  fit.parameters = meanParameters(parameters);
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

// The mean of all flights but one, on this one [%].
double percentByTheOthers(const std::vector<AxisModel>& flights, std::vector<LoopFit> fits, std::size_t one) {
  fits.erase(fits.begin() + static_cast<std::ptrdiff_t>(one));
  return predictLoop(meanFit(fits), flights[one].segments).fit_percent;
}

ControllerModel meanModel(const std::vector<AxisModel>& flights, std::size_t place) {
  ControllerModel mean = flights.front().controller_models[place];
  std::vector<LoopFit> fits;
  for (const AxisModel& flight : flights) fits.push_back(flight.controller_models[place].fit);
  mean.fit = meanFit(fits);
  mean.fit.fit_percent = 100.0;
  double by_others = 100.0;
  for (std::size_t i = 0; i < flights.size(); ++i) {
    mean.fit.fit_percent =
        std::min(mean.fit.fit_percent, predictLoop(mean.fit, flights[i].segments).fit_percent);
    by_others = std::min(by_others, percentByTheOthers(flights, fits, i));
  }
  if (mean.validation && !mean.validation->by_halves) {
    // Of another flight, which stays.
    by_others = predictLoop(mean.fit, mean.validation->segments).fit_percent;
  } else {
    mean.validation.emplace();
    mean.validation->by_flights = true;
  }
  mean.validation->training_percent = mean.fit.fit_percent;
  mean.validation->validation_percent = by_others;
  return mean;
}

std::vector<std::string> warningsOn(const AxisModel& mean) {
  std::vector<std::string> warnings;
  for (const AxisModel& flight : mean.flights) {
    for (const std::string& warning : flight.warnings)
      warnings.push_back(fileName(flight.source) + ": " + warning);
  }
  for (const char* name : {"gain", "tau"}) {
    std::vector<double> values;
    std::string text;
    for (const AxisModel& flight : mean.flights) {
      values.push_back(flight.with_delay.find(name)->value);
      text += (text.empty() ? "" : ", ") + sentence("%.3g", values.back());
    }
    const auto [least, greatest] = std::minmax_element(values.begin(), values.end());
    if (*greatest - *least <= kGreatSpread * std::abs(mean.with_delay.find(name)->value)) continue;
    warnings.push_back(std::string("The flights differ in ") + name + ": " + text +
                       ". Load, battery or wind were not the same, or it is not one vehicle.");
  }
  return warnings;
}

AxisModel meanOf(std::vector<AxisModel> flights, const FitOptions& bounds) {
  AxisModel mean;
  const AxisModel& first = flights.front();
  mean.axis = first.axis;
  mean.unit = first.unit;
  mean.command_unit = first.command_unit;
  for (const AxisModel& flight : flights) {
    mean.source += (mean.source.empty() ? "" : ", ") + flight.source;
    mean.lead = std::max(mean.lead, flight.lead);
  }
  for (std::size_t i = 0; i < first.controller_models.size(); ++i)
    mean.controller_models.push_back(meanModel(flights, i));
  mean.with_delay = mean.controller_models.front().fit;
  mean.validation = mean.controller_models.front().validation;
  mean.flights = std::move(flights);
  mean.warnings = warningsOn(mean);
  judgeModels(bounds, &mean);
  return mean;
}

}  // namespace

std::vector<FittedParameter> meanParameters(const std::vector<std::vector<FittedParameter>>& flights) {
  std::vector<FittedParameter> means = flights.front();
  for (std::size_t i = 0; i < means.size(); ++i) {
    FittedParameter& mean = means[i];
    double least = mean.value;
    double greatest = mean.value;
    mean.value = 0.0;
    for (const auto& flight : flights) {
      mean.value += flight[i].value / static_cast<double>(flights.size());
      least = std::min(least, flight[i].value);
      greatest = std::max(greatest, flight[i].value);
      // NaN where the data of a flight do not bound the number.
      mean.half_width = std::fmax(mean.half_width, flight[i].half_width);
    }
    mean.half_width = std::max(mean.half_width, 0.5 * (greatest - least));
  }
  return means;
}

AxisModel identifyFlights(const std::vector<AxisFlightRecords>& flights, const IdentifyOptions& options) {
  std::vector<std::string> left_out;
  std::vector<AxisModel> identified;
  for (const AxisFlightRecords& flight : flights) {
    IdentifyOptions own = options;
    own.windows = flight.windows;
    try {
      identified.push_back(identifyAxis(flight.records, own));
    } catch (const Error& error) {
      left_out.emplace_back(error.what());
    }
  }
  if (identified.empty()) throw Error(left_out.front());
  AxisModel model =
      identified.size() == 1 ? std::move(identified.front()) : meanOf(std::move(identified), options.fit);
  for (const std::string& sentence : left_out) model.warnings.push_back("Left out: " + sentence);
  return model;
}

}  // namespace polyfly
