#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/nonlinear_controller.hpp"

namespace polyfly {
namespace {

std::unique_ptr<ControlLaw> makeNonlinear(const LawParts& parts) {
  return std::make_unique<NonlinearController>(parts.controller, parts.nonlinear);
}

}  // namespace

LawType nonlinearType() { return {"nonlinear", makeNonlinear}; }

}  // namespace polyfly
