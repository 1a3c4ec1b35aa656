#include "online_controller_ros/law_sources.hpp"

#include "online_controller/axis.hpp"
#include "online_controller/linear_tuning.hpp"
#include "region_maps/error.hpp"

namespace polyfly_ros {
namespace {

constexpr double kSamplingTime = 0.1;  // of linear problems made from the model [s]
constexpr int kHorizon = 20;

std::vector<polyfly::RegionMap> openMaps(const std::array<std::string, 3>& paths,
                                         const polyfly::MultirotorOptions& options) {
  std::vector<polyfly::RegionMap> maps;
  if (paths[0].empty()) return maps;
  for (const std::string& path : paths) maps.push_back(polyfly::RegionMap::open(path));
  for (std::size_t i = 0; i < maps.size(); ++i) polyfly::Axis(maps[i], polyfly::kAxisNames[i], options);
  return maps;
}

/// Of one axis of the linear law; `made` where neither a file nor a map has one.
polyfly::MpcProblem problemOf(const std::string& path, const polyfly::RegionMap* map,
                              const polyfly::MpcProblem& made) {
  if (!path.empty()) return polyfly::loadProblem(path);
  if (map == nullptr || isRobust(*map)) return made;
  return polyfly::parseProblem(std::string(map->problemText()), map->path() + ": problem");
}

}  // namespace

bool isRobust(const polyfly::RegionMap& map) {
  return polyfly::parseFlightModel(std::string(map.problemText()), map.path() + ": problem").minimum_peak;
}

std::shared_ptr<const LawSources> LawSources::load(const LawFiles& files,
                                                   const polyfly::MultirotorModel& model,
                                                   const polyfly::MultirotorOptions& options) {
  auto sources = std::make_shared<LawSources>();
  sources->maps = openMaps(files.maps, options);
  sources->robust_maps = openMaps(files.robust_maps, options);
  for (const polyfly::RegionMap& map : sources->robust_maps) {
    // A map that promises nothing.
    if (!isRobust(map))
      throw polyfly::Error(map.path() +
                           ": problem: must be of type robust_mpc to be flown as robust_explicit");
  }
  const std::array<polyfly::MpcProblem, 3> made = polyfly::linearProblems(model, kSamplingTime, kHorizon);
  for (std::size_t i = 0; i < 3; ++i) {
    const polyfly::RegionMap* map = sources->maps.empty() ? nullptr : &sources->maps[i];
    sources->problems[i] = problemOf(files.problems[i], map, made[i]);
  }
  return sources;
}

}  // namespace polyfly_ros
