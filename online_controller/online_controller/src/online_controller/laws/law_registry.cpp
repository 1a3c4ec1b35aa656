#include "online_controller/laws/law_registry.hpp"

#include <utility>

#include "online_controller/laws/axis.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly {

// Each law is defined in a file of its own. A new one is declared and listed here.
LawType explicitLinearType();
LawType linearType();
LawType nonlinearType();
LawType robustExplicitType();

const std::vector<LawType>& lawTypes() {
  static const std::vector<LawType> kTypes{explicitLinearType(), linearType(), nonlinearType(),
                                           robustExplicitType()};
  return kTypes;
}

const char* lawName(Law law) noexcept { return lawTypes()[static_cast<std::size_t>(law)].name; }

Law lawOfName(const std::string& name) {
  std::string known;
  for (std::size_t i = 0; i < lawTypes().size(); ++i) {
    if (name == lawTypes()[i].name) return static_cast<Law>(i);
    known += (i == 0 ? "" : ", ") + std::string(lawTypes()[i].name);
  }
  throw Error("law: must be one of " + known + ", got '" + name + "'");
}

namespace {

MapSet openSet(const std::array<std::string, 3>& paths, const char* robust_law,
               const MultirotorOptions& options) {
  MapSet set;
  if (paths[0].empty()) return set;
  for (const std::string& path : paths) set.maps.push_back(RegionMap::open(path, kGreatestFlownMap));
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const AxisNames& names = kAxisNames.at(i);
    set.problems.at(i) = problemOf(set.maps[i], names.axis);
    // A map that promises nothing.
    if (robust_law != nullptr && !set.problems.at(i).minimum_peak) {
      throw Error(set.maps[i].path() + ": problem: must be of type robust_mpc to be flown as " + robust_law);
    }
    Axis(explicitAxisLaw(set.maps[i], set.problems.at(i)), names, options);
  }
  return set;
}

}  // namespace

std::vector<MapSet> openMaps(const std::vector<LawType>& types, const MapPaths& paths,
                             const MultirotorOptions& options) {
  std::vector<MapSet> sets;
  for (std::size_t i = 0; i < types.size(); ++i)
    sets.push_back(openSet(paths.at(i), types[i].robust_maps ? types[i].name : nullptr, options));
  return sets;
}

std::unique_ptr<LawSwitch> makeLaws(const std::vector<LawType>& types, const LawInputs& inputs, Law first) {
  const auto first_place = static_cast<std::size_t>(first);
  static const MapSet kNoMaps;
  std::vector<std::unique_ptr<ControlLaw>> laws;
  for (std::size_t i = 0; i < types.size(); ++i) {
    const bool has_maps = inputs.maps != nullptr && i < inputs.maps->size();
    laws.push_back(types[i].make(
        {inputs.controller, inputs.nonlinear, inputs.problems, has_maps ? (*inputs.maps)[i] : kNoMaps}));
  }
  if (laws.at(first_place) == nullptr) {
    throw Error(std::string("law: ") + types[first_place].name + " is not there to fly with");
  }
  return std::make_unique<LawSwitch>(std::move(laws), first, inputs.controller);
}

}  // namespace polyfly
