#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "nonlinear_mpc/multirotor_model.hpp"
#include "online_controller/laws/law_registry.hpp"
#include "online_controller/types/options.hpp"

namespace polyfly_ros {

struct LawFiles;

/// What the files hold, read and checked once and shared by all laws that are made from it.
struct LawSources {
  /// Of each law, in the order of lawTypes().
  std::vector<polyfly::MapSet> maps;
  /// Of the linear law: from the problem files, else the problems in the maps, else made from the model.
  std::array<polyfly::MpcProblem, 3> problems;

  const polyfly::MapSet& mapsOf(polyfly::Law law) const { return maps.at(static_cast<std::size_t>(law)); }
  /// Of the law whose problems the linear law solves too.
  const polyfly::MapSet& explicitMaps() const;

  /// Throws Error naming file, signal and rule.
  static std::shared_ptr<const LawSources> load(const LawFiles& files, const polyfly::MultirotorModel& model,
                                                const polyfly::MultirotorOptions& options);
};

}  // namespace polyfly_ros
