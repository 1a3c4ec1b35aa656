// The laws of MultirotorController: looked up in maps, or solved online.
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/multirotor_controller.hpp"

namespace polyfly {
namespace {

// Laws that fly together read the same references.
MultirotorOptions optionsFor(const std::array<MpcProblem, 3>& problems, const LawParts& parts) {
  MultirotorOptions options = parts.controller;
  options.look_ahead = options.look_ahead && problems[0].sampling_time == parts.nonlinear.period;
  return options;
}

std::unique_ptr<ControlLaw> makeExplicit(const LawParts& parts) {
  if (parts.maps.empty()) return nullptr;
  const std::vector<RegionMap>& maps = parts.maps.maps;
  return std::make_unique<MultirotorController>(std::array<const RegionMap*, 3>{&maps[0], &maps[1], &maps[2]},
                                                parts.maps.problems, optionsFor(parts.maps.problems, parts));
}

std::unique_ptr<ControlLaw> makeLinear(const LawParts& parts) {
  return std::make_unique<MultirotorController>(parts.problems, optionsFor(parts.problems, parts));
}

}  // namespace

LawType explicitLinearType() { return {"explicit_linear", makeExplicit, "maps"}; }

LawType linearType() { return {"linear", makeLinear}; }

LawType robustExplicitType() { return {"robust_explicit", makeExplicit, "robust_maps", true}; }

}  // namespace polyfly
