#include <algorithm>

#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"

namespace polyfly {
namespace {

std::unique_ptr<ControlLaw> makeNonlinear(const LawParts& parts) {
  MultirotorOptions options = parts.controller;
  // The law's weights depend on the dead time, which the problems may state.
  if (options.delay == 0.0) options.delay = std::max(parts.problems[0].delay, parts.problems[1].delay);
  return std::make_unique<NonlinearController>(options, parts.nonlinear);
}

}  // namespace

LawType nonlinearType() { return {"nonlinear", makeNonlinear}; }

}  // namespace polyfly
