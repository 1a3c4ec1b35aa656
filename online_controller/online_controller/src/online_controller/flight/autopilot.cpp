#include "online_controller/flight/autopilot.hpp"

namespace polyfly {

using Place = AutopilotReport::Place;

void AutopilotHistory::add(const AutopilotReport& report) noexcept {
  if (!report.fresh) {
    may_have_flown_ = true;
  } else if (!report.armed) {
    may_have_flown_ = false;
    was_grounded_ = true;
  } else if (report.place == Place::kOnGround) {
    was_grounded_ = true;
  } else {
    may_have_flown_ = true;
  }
}

IdleCommand idleCommand(const AutopilotReport& report, const AutopilotHistory& history,
                        bool streams) noexcept {
  if (!report.fresh) return IdleCommand::kNothing;
  const bool rests = !report.armed || (report.place == Place::kOnGround && !history.mayHaveFlown());
  if (rests) return streams ? IdleCommand::kZeroThrust : IdleCommand::kNothing;
  if (report.place != Place::kInAir) return IdleCommand::kNothing;
  if (!report.guided) return streams ? IdleCommand::kFollow : IdleCommand::kNothing;
  return streams || !history.wasGrounded() ? IdleCommand::kHold : IdleCommand::kNothing;
}

}  // namespace polyfly
