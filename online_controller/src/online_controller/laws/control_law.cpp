#include "online_controller/laws/control_law.hpp"

#include <cmath>

namespace polyfly {

void ControlLaw::sendInstead(const Substitute& sent) noexcept {
  if (std::isfinite(sent.stamp)) report_.stamp = sent.stamp;
  report_.status = sent.status;
  report_.reason = sent.reason;
  report_.command = sent.command;
  if (!sent.sampled) {
    // No parameters were assembled. What was estimated and applied still holds.
    for (AxisReport& axis : report_.axis) {
      AxisReport cleared;
      cleared.input = axis.input;
      cleared.disturbance = axis.disturbance;
      axis = cleared;
    }
  }
  if (sent.status != ControlStatus::kHoldLast) forget(LawMemory::kPlan);
}

}  // namespace polyfly
