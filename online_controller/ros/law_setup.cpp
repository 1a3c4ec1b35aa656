#include "online_controller_ros/law_setup.hpp"

#include <algorithm>
#include <utility>

#include "mpc_core/mpc_problem.hpp"
#include "online_controller/multirotor_controller.hpp"
#include "online_controller/nonlinear_controller.hpp"
#include "region_maps/error.hpp"

namespace polyfly_ros {
namespace {

constexpr std::array<const char*, 3> kAxes{"longitudinal", "lateral", "vertical"};

/// All three paths below `space`, or none. `required`: none will not do.
std::array<std::string, 3> readPaths(ParameterReader& reader, const std::string& space,
                                     const std::string& what, bool required) {
  std::array<std::string, 3> paths;
  for (std::size_t i = 0; i < 3; ++i) paths[i] = reader.text(space + "/" + kAxes[i], what, "");
  const bool any =
      std::any_of(paths.begin(), paths.end(), [](const std::string& path) { return !path.empty(); });
  for (std::size_t i = 0; i < 3; ++i) {
    if ((required || any) && paths[i].empty()) reader.requiredText(space + "/" + kAxes[i], what);
  }
  return paths;
}

std::vector<polyfly::RegionMap> openMaps(const std::array<std::string, 3>& paths) {
  std::vector<polyfly::RegionMap> maps;
  for (const std::string& path : paths) maps.push_back(polyfly::RegionMap::open(path));
  return maps;
}

std::unique_ptr<polyfly::ControlLaw> explicitLaw(const std::vector<polyfly::RegionMap>& maps,
                                                 const polyfly::MultirotorOptions& options) {
  return std::make_unique<polyfly::MultirotorController>(
      std::array<const polyfly::RegionMap*, 3>{&maps[0], &maps[1], &maps[2]}, options);
}

/// A robust map answers for the whole disturbance: what an observer took away would be answered twice. Throws
/// Error naming a map that promises nothing.
std::unique_ptr<polyfly::ControlLaw> robustLaw(const std::vector<polyfly::RegionMap>& maps,
                                               polyfly::MultirotorOptions options) {
  for (const polyfly::RegionMap& map : maps) {
    if (polyfly::parseFlightModel(std::string(map.problemText()), map.path() + ": problem").minimum_peak)
      continue;
    throw polyfly::Error(map.path() + ": problem: must be of type robust_mpc to be flown as robust_explicit");
  }
  options.offset_free = false;
  return explicitLaw(maps, options);
}

std::array<polyfly::MpcProblem, 3> problemsOf(const LawSetup& setup,
                                              const std::vector<polyfly::RegionMap>& maps) {
  std::array<polyfly::MpcProblem, 3> problems;
  for (std::size_t i = 0; i < 3; ++i) {
    problems[i] = setup.problem_paths[i].empty() ? polyfly::parseProblem(std::string(maps[i].problemText()),
                                                                         maps[i].path() + ": problem")
                                                 : polyfly::loadProblem(setup.problem_paths[i]);
  }
  return problems;
}

}  // namespace

LawSetup LawSetup::read(ParameterReader& reader) {
  LawSetup setup;
  setup.law = polyfly::lawOfName(reader.text("law", "the name of a law", "explicit_linear"));
  setup.map_paths =
      readPaths(reader, "maps", "the path of a region map", setup.law == polyfly::Law::kExplicitLinear);
  setup.robust_map_paths = readPaths(reader, "robust_maps", "the path of a map of a minimum-peak robust MPC",
                                     setup.law == polyfly::Law::kRobustExplicit);
  setup.problem_paths = readPaths(reader, "problems", "the path of a problem file",
                                  setup.law == polyfly::Law::kLinear && setup.map_paths[0].empty());
  polyfly::visitOptions(setup.controller, reader);
  polyfly::visitNonlinearOptions(setup.nonlinear, reader);
  return setup;
}

Laws::Laws(const LawSetup& setup) {
  std::array<std::unique_ptr<polyfly::ControlLaw>, polyfly::kLawCount> laws;
  const auto place = [&](polyfly::Law law) -> auto& { return laws[static_cast<std::size_t>(law)]; };
  if (!setup.map_paths[0].empty()) {
    maps_ = openMaps(setup.map_paths);
    place(polyfly::Law::kExplicitLinear) = explicitLaw(maps_, setup.controller);
    for (std::size_t i = 0; i < 3; ++i) parameters_[i] = maps_[i].parameters();
  }
  if (!maps_.empty() || !setup.problem_paths[0].empty()) {
    const std::array<polyfly::MpcProblem, 3> problems = problemsOf(setup, maps_);
    place(polyfly::Law::kLinear) =
        std::make_unique<polyfly::MultirotorController>(problems, setup.controller);
    for (std::size_t i = 0; i < 3 && maps_.empty(); ++i) {
      for (const auto& parameter : problems[i].parameters) parameters_[i].push_back(parameter.signal);
    }
  }
  if (!setup.robust_map_paths[0].empty()) {
    robust_maps_ = openMaps(setup.robust_map_paths);
    place(polyfly::Law::kRobustExplicit) = robustLaw(robust_maps_, setup.controller);
    for (std::size_t i = 0; i < 3; ++i) robust_parameters_[i] = robust_maps_[i].parameters();
  }
  place(polyfly::Law::kNonlinear) =
      std::make_unique<polyfly::NonlinearController>(setup.controller, setup.nonlinear);
  switch_ = std::make_unique<polyfly::LawSwitch>(std::move(laws), setup.law);
}

const std::vector<polyfly::RegionMap>& Laws::maps(polyfly::Law law) const {
  switch (law) {
    case polyfly::Law::kExplicitLinear:
      return maps_;
    case polyfly::Law::kRobustExplicit:
      return robust_maps_;
    case polyfly::Law::kLinear:
    case polyfly::Law::kNonlinear:
      break;
  }
  return no_maps_;
}

}  // namespace polyfly_ros
