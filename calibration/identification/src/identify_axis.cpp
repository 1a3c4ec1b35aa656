#include "identification/identify_axis.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnose.hpp"
#include "follow.hpp"
#include "identification/flight_phases.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {
namespace {

// Greatest frequency of the measured frequency response [Hz].
constexpr double kGreatestFrequency = 5.0;
constexpr int kFrequencyPoints = 60;
constexpr double kLongestBlock = 8.0;   // [s]
constexpr double kShortestBlock = 2.0;  // [s]
// Least length of a half for a fit [s].
constexpr double kLeastHalf = 2.0;

LoopRecord cleanRecord(const LoopRecord& record, CleaningCounts* counts) {
  LoopRecord clean = record;
  clean.command = cleaned(record.command, counts);
  clean.response = cleaned(record.response, counts);
  return clean;
}

double totalDuration(const std::vector<LoopSegment>& segments) {
  double sum = 0.0;
  for (const LoopSegment& segment : segments) sum += segment.duration();
  return sum;
}

// The segments in two halves of equal duration, the first one earlier.
std::pair<std::vector<TimeWindow>, std::vector<TimeWindow>> halves(const std::vector<LoopSegment>& segments) {
  std::pair<std::vector<TimeWindow>, std::vector<TimeWindow>> result;
  double left = 0.5 * totalDuration(segments);
  for (const LoopSegment& segment : segments) {
    const TimeWindow window = {segment.time.front(), segment.time.back()};
    if (left >= segment.duration()) {
      result.first.push_back(window);
    } else if (left <= 0.0) {
      result.second.push_back(window);
    } else {
      result.first.push_back({window.from, window.from + left});
      result.second.push_back({window.from + left, window.to});
    }
    left -= segment.duration();
  }
  return result;
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

std::optional<AxisValidationFit> validateByHalves(const LoopRecord& record,
                                                  const std::vector<LoopSegment>& segments,
                                                  const FitOptions& options) {
  const auto [first, second] = halves(segments);
  const std::vector<LoopSegment> training = cutSegments(record, first, options.delay_greatest);
  const std::vector<LoopSegment> rest = cutSegments(record, second, options.delay_greatest);
  if (totalDuration(training) < kLeastHalf || totalDuration(rest) < kLeastHalf) return std::nullopt;
  try {
    AxisValidationFit result = validateOn(fitLoop(training, options), record.source, rest);
    result.by_halves = true;
    return result;
  } catch (const Error&) {
    return std::nullopt;  // a half in which nothing moves says nothing
  }
}

double blockLength(const std::vector<LoopSegment>& segments) {
  double longest = 0.0;
  for (const LoopSegment& segment : segments) longest = std::max(longest, segment.duration());
  return std::clamp(0.4 * longest, kShortestBlock, kLongestBlock);
}

std::vector<TimeWindow> given(const std::vector<TimeWindow>& windows, const LoopRecord& record,
                              const IdentifyOptions& options, ExcitationChoice* choice) {
  *choice = chooseExcitation(record, options.excitation);
  if (windows.empty()) {
    keepWhatFollows(record, options.fit, options.excitation.least_window, choice);
    return choice->windows;
  }
  choice->windows = windows;
  choice->rejected.clear();
  return windows;
}

}  // namespace

AxisModel identifyAxis(const AxisRecords& records, const IdentifyOptions& options) {
  AxisModel model;
  model.axis = records.axis;
  model.unit = records.unit;
  model.command_unit = records.command_unit;
  model.source = records.training.source;
  model.smoothing = records.training.smoothing;
  model.cleaning = records.cleaning;
  model.record = cleanRecord(records.training, &model.cleaning);
  const std::string where = model.source + ": " + model.axis + ": ";
  if (model.record.command.time.empty()) throw Error(where + "no command");
  if (model.record.response.time.empty()) throw Error(where + "no response");
  const std::vector<TimeWindow> windows = given(options.windows, model.record, options, &model.choice);
  model.segments = cutSegments(model.record, windows, options.fit.delay_greatest);
  if (model.segments.empty()) {
    throw Error(where +
                (options.windows.empty() ? "no stretch in which the command moves and the response follows"
                                         : "the given windows hold no samples") +
                whyNotFlight(records.training.not_flight, options.windows) +
                whyUnusable(records.training.response));
  }
  FitOptions fit = options.fit;
  try {
    fit.order = LoopOrder::kFirst;
    fit.with_delay = false;
    model.without_delay = fitLoop(model.segments, fit);
    if (options.second_order) {
      fit.order = LoopOrder::kSecond;
      fit.with_delay = true;
      model.second_order = fitLoop(model.segments, fit);
    }
    fit.order = LoopOrder::kFirst;
    fit.with_delay = true;
    model.with_delay = fitLoop(model.segments, fit);
  } catch (const Error& error) {
    throw Error(where + error.what());
  }
  if (records.validation) {
    CleaningCounts ignored;
    const LoopRecord other = cleanRecord(*records.validation, &ignored);
    ExcitationChoice choice;
    const auto chosen = given(options.validation_windows, other, options, &choice);
    std::vector<LoopSegment> segments = cutSegments(other, chosen, options.fit.delay_greatest);
    if (segments.empty()) {
      throw Error(other.source + ": " + model.axis + ": nothing to validate on" +
                  whyUnusable(records.validation->response));
    }
    model.validation = validateOn(model.with_delay, other.source, std::move(segments));
  } else {
    model.validation = validateByHalves(model.record, model.segments, fit);
  }
  model.frequency_response = measureFrequencyResponse(model.segments, blockLength(model.segments),
                                                      kGreatestFrequency, kFrequencyPoints);
  model.warnings = diagnose(model, records, fit);
  model.supported = isSupported(model);
  return model;
}

}  // namespace polyfly
