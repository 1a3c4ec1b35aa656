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

/// A number that a law is tuned with.
struct LawOption {
  /// Name of the parameter, `group/name`.
  const char* key;
  /// Default.
  double value;
  const char* unit;
  Range range;
};

/// What one law is made from. It may keep references to the maps alone.
struct LawParts {
  const MultirotorOptions& controller;
  const NonlinearMpcOptions& nonlinear;
  /// Linear problems of the axes, tuned.
  const std::array<MpcProblem, 3>& problems;
  /// The law's own maps; empty where it has none, or none were given.
  const MapSet& maps;
  /// Values of LawType::options, in the same order.
  const std::vector<double>& options;
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

  /// Its own options, beside those of the vehicle and of the problems.
  std::vector<LawOption> options = {};
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
  /// Of each law.
  std::vector<std::vector<double>> options;
};

/// The defaults of LawType::options, for LawInputs::options.
std::vector<std::vector<double>> defaultLawOptions(const std::vector<LawType>& types);

/// Lists the laws' own options: visit(key, field, unit, range). `values` is of the form of defaultLawOptions().
template <class Values, class Visit>
void visitLawOptions(const std::vector<LawType>& types, Values& values, Visit&& visit) {
  for (std::size_t i = 0; i < types.size(); ++i) {
    for (std::size_t j = 0; j < types[i].options.size(); ++j) {
      const LawOption& option = types[i].options[j];
      visit(option.key, values[i][j], option.unit, option.range);
    }
  }
}

/// Every law that the inputs have what it needs for; `first` flies first. Throws Error naming what is missing or wrong.
std::unique_ptr<LawSwitch> makeLaws(const std::vector<LawType>& types, const LawInputs& inputs, Law first);

}  // namespace polyfly
