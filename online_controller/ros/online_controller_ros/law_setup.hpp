#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "nonlinear_mpc/nonlinear_mpc.hpp"
#include "online_controller/law_switch.hpp"
#include "online_controller/options.hpp"
#include "online_controller_ros/parameter_reader.hpp"
#include "region_maps/region_map.hpp"
#include "region_maps/signal.hpp"

namespace polyfly_ros {

/// What the laws are made from, as parameters tell it. Axes in the order longitudinal, lateral, vertical.
struct LawSetup {
  polyfly::Law law = polyfly::Law::kExplicitLinear;  ///< flies first
  std::array<std::string, 3> map_paths;              ///< empty where there are no maps
  std::array<std::string, 3> robust_map_paths;  ///< of minimum-peak robust MPC; empty where there are none
  std::array<std::string, 3> problem_paths;     ///< empty: the problems in the maps
  polyfly::MultirotorOptions controller;
  polyfly::NonlinearMpcOptions nonlinear;

  /// Throws Error naming a parameter.
  static LawSetup read(ParameterReader& reader);
};

/// Every law that the setup has the files for.
class Laws {
 public:
  /// Throws Error naming file, signal and rule.
  explicit Laws(const LawSetup& setup);

  polyfly::LawSwitch& flight() { return *switch_; }
  /// What an axis' report has for parameters while `law` flies.
  const std::array<std::vector<polyfly::Signal>, 3>& parameters(polyfly::Law law) const {
    return law == polyfly::Law::kRobustExplicit ? robust_parameters_ : parameters_;
  }
  /// What an explicit law looks its inputs up in: three; none where there are none, and of the other laws.
  const std::vector<polyfly::RegionMap>& maps(polyfly::Law law) const;

 private:
  std::vector<polyfly::RegionMap> maps_;
  std::vector<polyfly::RegionMap> robust_maps_;
  std::vector<polyfly::RegionMap> no_maps_;
  std::array<std::vector<polyfly::Signal>, 3> parameters_;  // of the linear laws
  std::array<std::vector<polyfly::Signal>, 3> robust_parameters_;
  std::unique_ptr<polyfly::LawSwitch> switch_;
};

}  // namespace polyfly_ros
