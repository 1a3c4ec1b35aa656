#pragma once

#include <string>

#include "online_controller/types/types.hpp"

namespace polyfly {

/// Whether a step is to be warned of although its answer is optimal.
inline bool hasRemark(const ControlReport& report) noexcept {
  return report.swings || !report.force_left.isZero(0.0);
}

/// What to warn of, for status, log and diagnostics; empty where there is nothing. Allocates.
std::string remarkOn(const ControlReport& report);

}  // namespace polyfly
