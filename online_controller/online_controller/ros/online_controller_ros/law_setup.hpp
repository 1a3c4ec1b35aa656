#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "nonlinear_mpc/nonlinear_mpc.hpp"
#include "online_controller/estimation/vehicle_observer.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller/types/options.hpp"
#include "polyfly_ros/parameter_reader.hpp"
#include "region_maps/signal.hpp"

namespace polyfly {
class RegionMap;
}

namespace polyfly_ros {

struct LawSources;

/// Files that laws are made from, empty where there is none. Axes in the order longitudinal, lateral,
/// vertical.
struct LawFiles {
  /// Of each law, in the order of lawTypes().
  polyfly::MapPaths maps;
  std::array<std::string, 3> problems;
};

/// What the laws are made from, as parameters tell it. Axes in the order longitudinal, lateral, vertical.
struct LawSetup {
  /// Law that flies first.
  polyfly::Law law{};
  LawFiles files;
  polyfly::MultirotorOptions controller;
  polyfly::NonlinearMpcOptions nonlinear;
  polyfly::LinearTuning linear;
  polyfly::MomentModel moments;
  /// Options of each law's own, in the order of lawTypes().
  std::vector<std::vector<double>> law_options = polyfly::defaultLawOptions(polyfly::lawTypes());
  /// Contents of the files.
  std::shared_ptr<const LawSources> sources;

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
  const std::vector<polyfly::RegionMap>& maps(polyfly::Law law) const;

 private:
  std::shared_ptr<const LawSources> sources_;
  polyfly::MultirotorOptions options_;
  polyfly::VehicleObserver observer_;
  // Of each law.
  std::vector<std::array<std::vector<polyfly::Signal>, 3>> parameters_;
  std::unique_ptr<polyfly::LawSwitch> switch_;
};

}  // namespace polyfly_ros
