#include "online_controller_ros/law_sources.hpp"

#include "online_controller/laws/axis.hpp"
#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller_ros/law_setup.hpp"
#include "polyfly_base/error.hpp"

namespace polyfly_ros {
namespace {

// Sampling time of linear problems that are made from the model [s].
constexpr double kSamplingTime = 0.1;
constexpr int kHorizon = 20;

MapSet openMaps(const std::array<std::string, 3>& paths, const polyfly::MultirotorOptions& options) {
  MapSet set;
  if (paths[0].empty()) return set;
  for (const std::string& path : paths) set.maps.push_back(polyfly::RegionMap::open(path));
  for (std::size_t i = 0; i < 3; ++i) {
    const polyfly::AxisNames& names = polyfly::kAxisNames.at(i);
    set.problems.at(i) = polyfly::problemOf(set.maps[i], names.axis);
    polyfly::Axis(polyfly::explicitAxisLaw(set.maps[i], set.problems.at(i)), names, options);
  }
  return set;
}

/// Of one axis of the linear law; `made` where neither a file nor a map has one.
polyfly::MpcProblem problemOf(const std::string& path, const MapSet& set, std::size_t axis,
                              const polyfly::MpcProblem& made) {
  if (!path.empty()) return polyfly::loadProblem(path);
  return set.empty() || set.problems.at(axis).minimum_peak ? made : set.problems.at(axis);
}

}  // namespace

std::shared_ptr<const LawSources> LawSources::load(const LawFiles& files,
                                                   const polyfly::MultirotorModel& model,
                                                   const polyfly::MultirotorOptions& options) {
  auto sources = std::make_shared<LawSources>();
  sources->explicit_maps = openMaps(files.maps, options);
  sources->robust_maps = openMaps(files.robust_maps, options);
  for (std::size_t i = 0; i < sources->robust_maps.maps.size(); ++i) {
    // A map that promises nothing.
    if (!sources->robust_maps.problems.at(i).minimum_peak)
      throw polyfly::Error(sources->robust_maps.maps[i].path() +
                           ": problem: must be of type robust_mpc to be flown as robust_explicit");
  }
  const std::array<polyfly::MpcProblem, 3> made = polyfly::linearProblems(model, kSamplingTime, kHorizon);
  for (std::size_t i = 0; i < 3; ++i) {
    sources->problems[i] = problemOf(files.problems[i], sources->explicit_maps, i, made[i]);
  }
  return sources;
}

}  // namespace polyfly_ros
