#pragma once

#include <string>

#include "identification/header_clock.hpp"

namespace polyfly {

/// Which times the signals of a topic have.
enum class SignalClock { kHeaders, kRecorder };

/// Chooses the clock of each topic of a flight. Topics whose stamps cannot be used have the recorder's times. Then the
/// others keep their stamps only if these are of the recorder's clock too.
class ClockChoice {
 public:
  /// A topic that gives a signal. All are added before the first question.
  void add(const HeaderClock& clock);

  SignalClock of(const HeaderClock& clock) const;

  /// Which clock is used, and what that means for a delay, as a clause. Empty where nothing is to be said.
  std::string clauseOn(const HeaderClock& clock) const;

 private:
  bool all_steady_ = true;
  // Greatest lead of steady stamps against the recorder, as an absolute value [s].
  double greatest_lead_ = 0.0;
};

}  // namespace polyfly
