#include "diagnose.hpp"

#include <cmath>

#include "polyfly_base/error.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

// Least gain of an angle loop whose command and response have one scale.
constexpr double kLeastGain = 0.7;
constexpr double kGreatestGain = 1.4;
constexpr double kDegree = 57.29577951308232;
// Greatest factor between a gain and the gain of degrees for which degrees are suspected.
constexpr double kDegreeMargin = 1.5;
// Greatest drop of the fit from training to validation [%].
constexpr double kDropFit = 8.0;
// Lead of the response before the command above which clocks disagree [s].
constexpr double kLeadClock = 0.02;
// Least delay that is one [s].
constexpr double kLeastDelay = 1e-3;
// Least gain of the fit by which a lead shows [%].
constexpr double kLeadGain = 0.5;
constexpr double kLongDelay = 0.45;  // [s]
// Greatest lead that is searched for [s].
constexpr double kClockBound = 0.5;
// Share of the samples that may be left out without a warning.
constexpr double kManyLeftOut = 0.02;
// Share of the time with a moving command in which the response must follow.
constexpr double kFollowedShare = 0.85;
// Correlation above which a signal follows a command.
constexpr double kFollows = 0.7;
// Factor by which the correlation of another axis must exceed the own correlation.
constexpr double kFrameFactor = 1.3;

using Sentences = std::vector<std::string>;

void judgeScale(const AxisModel& model, const AxisRecords& records, Sentences* warnings) {
  if (model.with_delay.find("gain")->greatest() < 0.0) {
    warnings->emplace_back(
        "The response goes against the command: the sign or the frame (y left or right, z up or down) of one "
        "of them is wrong.");
  }
  const double size = std::abs(model.with_delay.gain);
  if (model.axis == "thrust" || (size >= kLeastGain && size <= kGreatestGain)) return;
  const auto near = [size](double value) {
    return size > value / kDegreeMargin && size < value * kDegreeMargin;
  };
  if (near(kDegree) || near(1.0 / kDegree)) {
    warnings->push_back(sentence("The gain is %.4g: one of command and response is in degrees; ", size) +
                        (size > 1.0 ? records.response_help : records.command_help) + ".");
  } else {
    warnings->push_back(sentence(
        "The gain is %.3g, where a loop that reaches its command has about 1: command and response are on "
        "different scales, or the command is not that of this loop.",
        size));
  }
}

// Mean correlation over what was used, of a command with the response of the loop or with another one.
double correlationOf(const AxisModel& model, const TimeSeries& command, const TimeSeries* response) {
  double sum = 0.0;
  double seconds = 0.0;
  for (const LoopSegment& segment : model.segments) {
    const TimeWindow window = {segment.time.front(), segment.time.back()};
    const TimeSeries own = {segment.time, segment.response};
    sum += segment.duration() *
           std::abs(bestCorrelation(command, response != nullptr ? *response : own, window, 1.0));
    seconds += segment.duration();
  }
  return sum / seconds;
}

void judgeFrame(const AxisModel& model, const AxisRecords& records, Sentences* warnings) {
  const double own = correlationOf(model, model.record.command, nullptr);
  if (records.other_command && !records.other_command->time.empty()) {
    const double other = correlationOf(model, *records.other_command, nullptr);
    if (other > kFrameFactor * own) {
      warnings->push_back(
          sentence("The response follows the command of the other axis (correlation %.2f) more than its own "
                   "(%.2f): the "
                   "axes are swapped, or the frame is turned by the yaw angle.",
                   other, own));
    }
  }
  if (!records.vertical_velocity || records.vertical_velocity->time.empty()) return;
  const double rate = correlationOf(model, model.record.command, &*records.vertical_velocity);
  if (rate > kFrameFactor * own && rate > kFollows) {
    warnings->push_back(
        sentence("The vertical velocity follows the command (correlation %.2f) more than the acceleration "
                 "(%.2f): it is "
                 "a command of climb rate, not of thrust.",
                 rate, own));
  }
}

void judgeClock(const AxisModel& model, const FitOptions& bounds, Sentences* warnings) {
  const double delay = model.with_delay.shape.delay;
  if (delay > kLongDelay || delay > 0.98 * bounds.delay_greatest) {
    warnings->push_back(sentence(
        "The delay of %.2f s is longer than a loop's own: the clocks of command and response may disagree.",
        delay));
  }
  if (model.lead > 0.0) warnings->push_back(leadSentence(model.lead));
}

void judgeData(const AxisModel& model, const AxisRecords& records, Sentences* warnings) {
  if (model.validation &&
      model.validation->validation_percent < model.validation->training_percent - kDropFit) {
    warnings->push_back(
        sentence("The fit falls from %.1f %% on the data it was made from to %.1f %% on others.",
                 model.validation->training_percent, model.validation->validation_percent));
  }
  const auto samples = [](const LoopRecord& record) {
    return static_cast<double>(record.response.time.size() + record.command.time.size());
  };
  const double all = samples(records.training);
  const double left_out = all - samples(model.record);
  if (left_out > kManyLeftOut * all) {
    warnings->push_back(
        sentence("%.0f of %.0f samples were left out: they are not finite, or their times do not increase.",
                 left_out, all));
  }
  // What was left out because the response does not follow, against what was used.
  if (model.usedTime() < kFollowedShare * model.movingTime()) {
    warnings->push_back(sentence(
        "The response follows the command in %.1f s of %.1f s only: another mode flew, or the command is not "
        "that of this loop.",
        model.usedTime(), model.movingTime()));
  }
}

}  // namespace

double leadOf(const LoopFit& with_delay, const std::vector<LoopSegment>& segments, FitOptions bounds) {
  if (with_delay.shape.delay > kLeastDelay) return 0.0;
  bounds.delay_least = -kClockBound;
  const LoopFit fit = fitLoop(segments, bounds);
  const bool leads = fit.shape.delay < -kLeadClock && fit.find("delay")->greatest() < 0.0 &&
                     fit.fit_percent > with_delay.fit_percent + kLeadGain;
  return leads ? -fit.shape.delay : 0.0;
}

std::string leadSentence(double lead) {
  return sentence(
      "The response comes %.3f s before its command: the clocks of the two disagree, or the command was "
      "logged late.",
      lead);
}

std::vector<std::string> diagnose(const AxisModel& model, const AxisRecords& records,
                                  const FitOptions& bounds) {
  std::vector<std::string> warnings;
  judgeScale(model, records, &warnings);
  judgeFrame(model, records, &warnings);
  judgeClock(model, bounds, &warnings);
  judgeData(model, records, &warnings);
  return warnings;
}

}  // namespace polyfly
