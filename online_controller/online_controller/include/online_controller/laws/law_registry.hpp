#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "nonlinear_mpc/nonlinear_mpc.hpp"
#include "online_controller/laws/law_switch.hpp"
#include "online_controller/types/options.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly {

/// Region maps of one law, none or three, and the problems that they were made from. Axes in the order longitudinal,
/// lateral, vertical.
struct MapSet {
  std::vector<RegionMap> maps;
  std::array<MpcProblem, 3> problems;

  bool empty() const noexcept { return maps.empty(); }
};

/// What one law is made from. It may keep references to the maps alone.
struct LawParts {
  const MultirotorOptions& controller;
  const NonlinearMpcOptions& nonlinear;
  /// Linear problems of the axes, tuned.
  const std::array<MpcProblem, 3>& problems;
  /// The law's own maps; empty where it has none, or none were given.
  const MapSet& maps;
};

/// A law that a multirotor can fly with.
struct LawType {
  /// Value of the parameter `law`.
  const char* name = nullptr;

  /// Makes the law; nullptr where what it is made from was not given. Throws Error naming file, signal and rule.
  std::unique_ptr<ControlLaw> (*make)(const LawParts& parts) = nullptr;

  /// Parameter group of the paths of its maps (GROUP/longitudinal, ...); nullptr: it has no maps.
  const char* maps = nullptr;
  /// True: each of its maps must be that of a robust_mpc.
  bool robust_maps = false;
};

/// All laws: a line each in law_registry.cpp. A value of Law is a place in this list.
const std::vector<LawType>& lawTypes();

/// Paths of the maps of each law, in the order of the types; empty where none are given. Axes as in MapSet.
using MapPaths = std::vector<std::array<std::string, 3>>;

/// The maps of each law. Throws Error naming map, signal and rule unless each map can fly its axis.
std::vector<MapSet> openMaps(const std::vector<LawType>& types, const MapPaths& paths,
                             const MultirotorOptions& options);

/// `explicit_linear`, `linear`, ...
const char* lawName(Law law) noexcept;

/// The law of that name. Throws Error naming what there is.
Law lawOfName(const std::string& name);

/// What all laws are made from, in the order of the types.
struct LawInputs {
  MultirotorOptions controller;
  NonlinearMpcOptions nonlinear;
  std::array<MpcProblem, 3> problems;
  /// Of each law; the laws keep references to them.
  const std::vector<MapSet>* maps = nullptr;
};

/// Every law that the inputs have what it needs for; `first` flies first. Throws Error naming what is missing or wrong.
std::unique_ptr<LawSwitch> makeLaws(const std::vector<LawType>& types, const LawInputs& inputs, Law first);

}  // namespace polyfly
