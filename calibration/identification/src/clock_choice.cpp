#include "clock_choice.hpp"

#include <algorithm>
#include <cmath>

#include "sentence.hpp"

namespace polyfly {

void ClockChoice::add(const HeaderClock& clock) {
  if (clock.isSteady()) {
    greatest_lead_ = std::max(greatest_lead_, std::abs(clock.lead));
  } else {
    all_steady_ = false;
  }
}

SignalClock ClockChoice::of(const HeaderClock& clock) const {
  const bool one_clock = all_steady_ || greatest_lead_ <= kLeastClockStep;
  return clock.isSteady() && one_clock ? SignalClock::kHeaders : SignalClock::kRecorder;
}

std::string ClockChoice::clauseOn(const HeaderClock& clock) const {
  if (of(clock) == SignalClock::kHeaders)
    return clock.steps.empty() ? "" : "the times of the headers are used";
  if (clock.isSteady())
    return "the times of the recorder are used: the headers have another clock, and other topics have no "
           "usable stamps";
  std::string clause = "the times of the recorder are used";
  if (greatest_lead_ > 0.0 && greatest_lead_ <= kLeastClockStep) {
    clause += sentence(
        "; other messages reached it up to %.3g s after their stamps, and a delay may be off by as much",
        greatest_lead_);
  }
  return clause;
}

}  // namespace polyfly
