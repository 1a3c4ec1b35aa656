#include "identification/header_clock.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace polyfly {
namespace {

// Steps that get a clause of their own.
constexpr std::size_t kMostClauses = 3;

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Stamped {
  std::vector<double> stamp;
  std::vector<double> received;

  double lead(std::size_t index) const { return stamp[index] - received[index]; }
  double medianLead(std::size_t begin, std::size_t end) const {
    std::vector<double> leads;
    for (std::size_t index = begin; index < end; ++index) leads.push_back(lead(index));
    return median(std::move(leads));
  }
};

// Index of each message behind a step, the first message and the number of messages at both ends.
std::vector<std::size_t> edgesOf(const Stamped& messages) {
  std::vector<std::size_t> edges = {0};
  for (std::size_t index = 1; index < messages.stamp.size(); ++index) {
    if (std::abs(messages.lead(index) - messages.lead(index - 1)) > kLeastClockStep) edges.push_back(index);
  }
  edges.push_back(messages.stamp.size());
  return edges;
}

// The clock whose step is farther from what is usual between two messages is the one that jumped.
bool isOfHeaders(const Stamped& messages, std::size_t index, double usual) {
  const double stamps = messages.stamp[index] - messages.stamp[index - 1];
  const double received = messages.received[index] - messages.received[index - 1];
  return std::abs(stamps - usual) > std::abs(received - usual);
}

std::vector<ClockStep> stepsOf(const Stamped& messages) {
  std::vector<double> periods;
  for (std::size_t index = 1; index < messages.stamp.size(); ++index)
    periods.push_back(messages.stamp[index] - messages.stamp[index - 1]);
  const double usual = median(std::move(periods));
  const std::vector<std::size_t> edges = edgesOf(messages);
  std::vector<ClockStep> steps;
  for (std::size_t edge = 1; edge + 1 < edges.size(); ++edge) {
    const std::size_t index = edges[edge];
    const double by = messages.lead(index) - messages.lead(index - 1);
    const bool of_headers = isOfHeaders(messages, index, usual);
    // Messages that were held up for a while come late, and soon in time again.
    const double lasting =
        messages.medianLead(index, edges[edge + 1]) - messages.medianLead(edges[edge - 1], index);
    if (!of_headers && std::abs(lasting) <= kLeastClockStep) continue;
    steps.push_back({messages.received[index], by, of_headers});
  }
  return steps;
}

std::string clauseOn(const ClockStep& step, double start) {
  std::array<char, 160> text{};
  std::snprintf(text.data(), text.size(), "%s jumps by %.4g s against %s, %.4g s after the first message",
                step.of_headers ? "the clock of the headers" : "the recorder's clock",
                step.of_headers ? step.by : -step.by,
                step.of_headers ? "the recorder's" : "that of the headers", step.at - start);
  return text.data();
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
  clock.steps = stepsOf(messages);
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
