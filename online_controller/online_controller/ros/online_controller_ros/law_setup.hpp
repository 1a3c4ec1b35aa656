#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/estimation/vehicle_observer.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/parameters/multirotor_parameters.hpp"
#include "polyfly_ros/parameter_reader.hpp"
#include "region_maps/signal.hpp"

namespace polyfly_ros {

/// What the files of maps and problems hold, read and checked once and shared by all laws that are made from it. Axes in
/// the order longitudinal, lateral, vertical.
struct LawSources {
  /// Of each law, in the order of lawTypes().
  std::vector<polyfly::MapSet> maps;
  /// Of the linear law: from the problem files, else the problems in the maps, else made from the model.
  std::array<polyfly::MpcProblem, 3> problems;

  const polyfly::MapSet& mapsOf(polyfly::Law law) const { return maps.at(static_cast<std::size_t>(law)); }
  /// Of the law whose problems the linear law solves too.
  const polyfly::MapSet& explicitMaps() const;

  /// Throws Error naming file, signal and rule.
  static std::shared_ptr<const LawSources> load(const polyfly::MultirotorParameters& parameters);
};

/// What the laws are made from, and all else that parameters tell the node.
struct LawSetup {
  polyfly::MultirotorParameters parameters;
  /// Contents of the files that they name.
  std::shared_ptr<const LawSources> sources;

  /// Law that flies first.
  polyfly::Law law() const { return polyfly::lawOfName(parameters.law); }

  /// Reads the files too. Throws Error naming a parameter, or a file.
  static LawSetup read(ParameterReader& reader);
};

/// Every law that the setup has what it needs for.
class Laws {
 public:
  /// Shares the sources. Throws Error naming file, signal and rule.
  explicit Laws(const LawSetup& setup);

  polyfly::LawSwitch& flight() { return *switch_; }
  const polyfly::LawSwitch& flight() const { return *switch_; }
  const polyfly::MultirotorOptions& options() const { return options_; }
  /// Has observed nothing: the state of the published one is to be transferred to it.
  const polyfly::VehicleObserver& observer() const { return observer_; }
  /// What an axis' report has for parameters while `law` flies.
  const std::array<std::vector<polyfly::Signal>, 3>& parameters(polyfly::Law law) const {
    return parameters_.at(static_cast<std::size_t>(law));
  }
  /// What an explicit law looks its inputs up in: three; none where there are none, and of the other laws.
  const std::vector<polyfly::RegionMap>& maps(polyfly::Law law) const { return sources_->mapsOf(law).maps; }

 private:
  std::shared_ptr<const LawSources> sources_;
  polyfly::MultirotorOptions options_;
  polyfly::VehicleObserver observer_;
  // Of each law.
  std::vector<std::array<std::vector<polyfly::Signal>, 3>> parameters_;
  std::unique_ptr<polyfly::LawSwitch> switch_;
};

}  // namespace polyfly_ros
