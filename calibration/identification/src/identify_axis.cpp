#include "identification/identify_axis.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "diagnose.hpp"
#include "follow.hpp"
#include "identification/flight_phases.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Least length of a half for a fit [s].
constexpr double kLeastHalf = 2.0;

LoopRecord cleanRecord(const LoopRecord& record) {
  LoopRecord clean = record;
  clean.command = cleaned(record.command);
  clean.response = cleaned(record.response);
  return clean;
}

double totalDuration(const std::vector<LoopSegment>& segments) {
  double sum = 0.0;
  for (const LoopSegment& segment : segments) sum += segment.duration();
  return sum;
}

// Time by which half of the segments is over.
double middleOf(const std::vector<LoopSegment>& segments) {
  double left = 0.5 * totalDuration(segments);
  for (const LoopSegment& segment : segments) {
    if (left <= segment.duration()) return segment.time.front() + left;
    left -= segment.duration();
  }
  return segments.back().time.back();
}

AxisValidationFit validateOn(const LoopFit& fit, std::string source, std::vector<LoopSegment> segments) {
  AxisValidationFit result;
  result.source = std::move(source);
  LoopPrediction prediction = predictLoop(fit, segments);
  result.training_percent = fit.fit_percent;
  result.validation_percent = prediction.fit_percent;
  result.prediction = std::move(prediction.prediction);
  result.segments = std::move(segments);
  return result;
}

// The models of one set of segments, in the order of kModels.
std::vector<LoopFit> fitModels(const LoopFit& with_delay, const std::vector<LoopSegment>& segments,
                               FitOptions options, std::size_t count) {
  std::vector<LoopFit> fits = {with_delay};
  if (count > 1) fits.push_back(equivalentLag(with_delay, segments));
  options.order = LoopOrder::kSecond;
  for (const bool delayed : {true, false}) {
    if (fits.size() == count) break;
    options.with_delay = delayed;
    fits.push_back(fitLoop(segments, options));
  }
  return fits;
}

struct ModelName {
  const char* key;
  const char* title;
};
constexpr ModelName kModels[] = {{"model", "lag and delay"},
                                 {"model_without_delay", "lag as handed out"},
                                 {"model_second_order", "second order and delay"},
                                 {"model_second_order_without_delay", "second order alone"}};

std::size_t modelCount(const std::string& axis, bool second_order) {
  if (axis == "thrust") return 1;
  return second_order ? 4 : 2;
}

// The models of the first half, each validated on the second; none where a half says too little.
std::vector<AxisValidationFit> validateByHalves(const AxisModel& model, const FitOptions& options) {
  constexpr double kEver = std::numeric_limits<double>::infinity();
  const double middle = middleOf(model.segments);
  const auto segments_without = [&](const TimeWindow& half) {
    return cutSegments(model.record, windowsWithout(model.choice.windows, {{half, ""}}),
                       options.delay_greatest);
  };
  const std::vector<LoopSegment> training = segments_without({middle, kEver});
  const std::vector<LoopSegment> rest = segments_without({-kEver, middle});
  if (totalDuration(training) < kLeastHalf || totalDuration(rest) < kLeastHalf) return {};
  try {
    std::vector<AxisValidationFit> results;
    for (const LoopFit& fit :
         fitModels(fitLoop(training, options), training, options, model.controller_models.size())) {
      results.push_back(validateOn(fit, model.source, rest));
      results.back().by_halves = true;
    }
    return results;
  } catch (const Error&) {
    return {};  // a half in which nothing moves says nothing
  }
}

// Every model of the axis on its segments.
void fitAll(const FitOptions& options, bool second_order, AxisModel* model) {
  model->with_delay = fitLoop(model->segments, options);
  std::vector<LoopFit> fits =
      fitModels(model->with_delay, model->segments, options, modelCount(model->axis, second_order));
  for (std::size_t i = 0; i < fits.size(); ++i)
    model->controller_models.push_back({kModels[i].key, kModels[i].title, std::move(fits[i]), {}, {}});
}

ExcitationChoice chosenWindows(const std::vector<TimeWindow>& given, const LoopRecord& record,
                               const FitOptions& fit) {
  if (!given.empty()) return {given, {}};
  ExcitationChoice choice = chooseExcitation(record);
  keepWhatFollows(record, fit, &choice);
  return choice;
}

// Every controller model on another flight.
std::vector<AxisValidationFit> validateOnFlight(const AxisModel& model, const LoopRecord& record,
                                                const IdentifyOptions& options) {
  const LoopRecord clean = cleanRecord(record);
  const std::vector<LoopSegment> segments =
      cutSegments(clean, chosenWindows({}, clean, options.fit).windows, options.fit.delay_greatest);
  if (segments.empty()) {
    throw Error(clean.source + ": " + model.axis + ": nothing to validate on" + whyUnusable(record.response));
  }
  std::vector<AxisValidationFit> results;
  for (const ControllerModel& one : model.controller_models)
    results.push_back(validateOn(one.fit, clean.source, segments));
  return results;
}

}  // namespace

double AxisModel::usedTime() const {
  double used = 0.0;
  for (const TimeWindow& window : choice.windows) used += window.to - window.from;
  for (const AxisModel& flight : flights) used += flight.usedTime();
  return used;
}

double AxisModel::movingTime() const {
  double moving = 0.0;
  for (const TimeWindow& window : choice.windows) moving += window.to - window.from;
  for (const AxisModel& flight : flights) moving += flight.movingTime();
  for (const RejectedWindow& rejected : choice.rejected) {
    if (rejected.reason == kDoesNotFollow) moving += rejected.window.to - rejected.window.from;
  }
  return moving;
}

const ControllerModel* AxisModel::findModel(const std::string& key) const {
  for (const ControllerModel& one : controller_models) {
    if (one.key == key) return &one;
  }
  return nullptr;
}

void judgeModels(const FitOptions& bounds, AxisModel* model) {
  for (ControllerModel& one : model->controller_models) {
    one.reasons = reasonsAgainst(one, model->axis, bounds);
    if (model->lead > 0.0) one.reasons.push_back(leadSentence(model->lead));
  }
  const ControllerModel* handed_out = model->findModel("model_without_delay");
  model->supported = (handed_out != nullptr ? *handed_out : model->controller_models.front()).supported();
}

namespace {

// The clean record and the windows to fit to. Throws Error where a signal is empty or nothing is left of it.
AxisModel chooseWindows(const AxisRecords& records, const IdentifyOptions& options) {
  AxisModel model;
  model.axis = records.axis;
  model.unit = records.unit;
  model.command_unit = records.command_unit;
  model.source = records.training.source;
  model.record = cleanRecord(records.training);
  const std::string where = model.source + ": " + model.axis + ": ";
  if (model.record.command.time.empty()) throw Error(where + "no command");
  if (model.record.response.time.empty()) throw Error(where + "no response");
  model.choice = chosenWindows(options.windows, model.record, options.fit);
  model.segments = cutSegments(model.record, model.choice.windows, options.fit.delay_greatest);
  if (model.segments.empty()) {
    throw Error(where +
                (options.windows.empty() ? "no stretch in which the command moves and the response follows"
                                         : "the given windows hold no samples") +
                whyNotFlight(records.training.not_flight, options.windows) +
                whyUnusable(records.training.response));
  }
  return model;
}

// Fits all models to the segments, validates and warns.
void fitAxis(const AxisRecords& records, const IdentifyOptions& options, AxisModel* model) {
  const std::string where = model->source + ": " + model->axis + ": ";
  FitOptions fit = options.fit;
  fit.order = LoopOrder::kFirst;
  fit.with_delay = true;
  try {
    fitAll(fit, options.second_order, model);
  } catch (const Error& error) {
    throw Error(where + error.what());
  }
  std::vector<AxisValidationFit> validation = records.validation
                                                  ? validateOnFlight(*model, *records.validation, options)
                                                  : validateByHalves(*model, fit);
  for (std::size_t i = 0; i < validation.size(); ++i)
    model->controller_models[i].validation = std::move(validation[i]);
  model->validation = model->controller_models.front().validation;
  model->lead = leadOf(model->with_delay, model->segments, fit);
  model->warnings = diagnose(*model, records, fit);
  judgeModels(fit, model);
}

}  // namespace

AxisModel identifyAxis(const AxisRecords& records, const IdentifyOptions& options) {
  AxisModel model = chooseWindows(records, options);
  fitAxis(records, options, &model);
  return model;
}

}  // namespace polyfly
