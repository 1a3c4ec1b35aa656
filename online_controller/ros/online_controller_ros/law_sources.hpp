#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mpc_core/mpc_problem.hpp"
#include "nonlinear_mpc/multirotor_model.hpp"
#include "online_controller/types/options.hpp"
#include "region_maps/region_map.hpp"

namespace polyfly_ros {

struct LawFiles;

/// Region maps of one law, none or three, and the problems that they were made from.
struct MapSet {
  std::vector<polyfly::RegionMap> maps;
  std::array<polyfly::MpcProblem, 3> problems;

  bool empty() const noexcept { return maps.empty(); }
};

/// What the files hold, read and checked once and shared by all laws that are made from it.
struct LawSources {
  MapSet explicit_maps;
  MapSet robust_maps;
  /// Of the linear law: from the problem files, else the problems in the maps, else made from the model.
  std::array<polyfly::MpcProblem, 3> problems;

  /// Throws Error naming file, signal and rule.
  static std::shared_ptr<const LawSources> load(const LawFiles& files, const polyfly::MultirotorModel& model,
                                                const polyfly::MultirotorOptions& options);
};

}  // namespace polyfly_ros
