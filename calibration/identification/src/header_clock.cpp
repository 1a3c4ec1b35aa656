#include "identification/header_clock.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "polyfly_base/quantile.hpp"
#include "sentence.hpp"

namespace polyfly {
namespace {

// Steps that get a clause of their own.
constexpr std::size_t kMostClauses = 3;

struct Stamped {
  std::vector<double> stamp;
  std::vector<double> received;

  double lead(std::size_t index) const { return stamp[index] - received[index]; }
  double medianLead(std::size_t begin, std::size_t end) const {
    std::vector<double> leads;
    for (std::size_t index = begin; index < end; ++index) leads.push_back(lead(index));
    return quantileOf(std::move(leads));
  }
};

// A step of the recorder's time, by the index of the message behind it.
struct RecorderSteps {
  std::vector<std::size_t> places;
  // Lead of each message, without the steps of the headers.
  std::vector<double> leads;

  double greatest(std::size_t begin, std::size_t end) const {
    return *std::max_element(leads.begin() + static_cast<std::ptrdiff_t>(begin),
                             leads.begin() + static_cast<std::ptrdiff_t>(end));
  }
  // Messages that come late lead less than those in time, and the last ones lead as the first ones.
  bool areLateness() const {
    const double before = greatest(0, places.front());
    return std::abs(greatest(places.back(), leads.size()) - before) <= kLeastClockStep &&
           greatest(0, leads.size()) <= before + kLeastClockStep;
  }
};

double usualPeriod(const std::vector<double>& stamps) {
  std::vector<double> periods;
  for (std::size_t index = 1; index < stamps.size(); ++index)
    periods.push_back(stamps[index] - stamps[index - 1]);
  return quantileOf(std::move(periods));
}

void findSteps(const Stamped& messages, HeaderClock* clock) {
  if (messages.stamp.empty()) return;
  const double usual = usualPeriod(messages.stamp);
  RecorderSteps recorder{{}, {messages.lead(0)}};
  double of_headers = 0.0;
  double best = messages.lead(0);
  for (std::size_t index = 1; index < messages.stamp.size(); ++index) {
    const double stamps = messages.stamp[index] - messages.stamp[index - 1];
    const double received = messages.received[index] - messages.received[index - 1];
    const double by = messages.lead(index) - messages.lead(index - 1);
    const double lead = messages.lead(index) - of_headers;
    if (std::abs(by) > kLeastClockStep) {
      // A recorder that was late is in time again where messages between were lost.
      const bool caught_up = by > 0.0 && stamps > 0.0 && lead <= best + kLeastClockStep;
      // The clock whose step is farther from what is usual between two messages is the one that jumped.
      if (!caught_up && std::abs(stamps - usual) > std::abs(received - usual)) {
        clock->steps.push_back({messages.received[index], by, true});
        of_headers += by;
      } else {
        recorder.places.push_back(index);
      }
    }
    recorder.leads.push_back(messages.lead(index) - of_headers);
    best = std::max(best, recorder.leads.back());
  }
  if (recorder.places.empty()) return;
  if (recorder.areLateness()) {
    clock->late = recorder.greatest(0, recorder.places.front()) -
                  *std::min_element(recorder.leads.begin(), recorder.leads.end());
    return;
  }
  for (const std::size_t index : recorder.places)
    clock->steps.push_back(
        {messages.received[index], messages.lead(index) - messages.lead(index - 1), false});
  std::sort(clock->steps.begin(), clock->steps.end(),
            [](const ClockStep& one, const ClockStep& other) { return one.at < other.at; });
}

std::string clauseOn(const ClockStep& step, double start) {
  return sentence("%s jumps by %.4g s against %s, %.4g s after the first message",
                  step.of_headers ? "the clock of the headers" : "the recorder's clock",
                  step.of_headers ? step.by : -step.by,
                  step.of_headers ? "the recorder's" : "that of the headers", step.at - start);
}

}  // namespace

bool HeaderClock::isSteady() const {
  return without_stamp == 0 &&
         std::none_of(steps.begin(), steps.end(), [](const ClockStep& step) { return step.of_headers; });
}

HeaderClock headerClock(const std::vector<double>& stamps, const std::vector<double>& received) {
  HeaderClock clock;
  clock.messages = stamps.size();
  Stamped messages;
  for (std::size_t index = 0; index < stamps.size(); ++index) {
    if (!(stamps[index] > 0.0)) {
      ++clock.without_stamp;
      continue;
    }
    messages.stamp.push_back(stamps[index]);
    messages.received.push_back(received[index]);
  }
  findSteps(messages, &clock);
  clock.lead = messages.medianLead(0, messages.stamp.size());
  return clock;
}

std::vector<std::string> clausesOn(const HeaderClock& clock, double start) {
  std::vector<std::string> clauses;
  if (clock.without_stamp > 0) {
    clauses.push_back(std::to_string(clock.without_stamp) + " of " + std::to_string(clock.messages) +
                      " messages have no stamp");
  }
  for (std::size_t index = 0; index < std::min(clock.steps.size(), kMostClauses); ++index)
    clauses.push_back(clauseOn(clock.steps[index], start));
  if (clock.steps.size() > kMostClauses)
    clauses.push_back(std::to_string(clock.steps.size() - kMostClauses) + " more such jumps follow");
  return clauses;
}

}  // namespace polyfly
