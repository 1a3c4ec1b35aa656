#include "online_controller_ros/law_sources.hpp"

#include "online_controller/laws/linear_tuning.hpp"
#include "online_controller_ros/law_setup.hpp"

namespace polyfly_ros {
namespace {

// Sampling time of linear problems that are made from the model [s].
constexpr double kSamplingTime = 0.1;
constexpr int kHorizon = 20;

/// Of one axis of the linear law; `made` where neither a file nor a map has one.
polyfly::MpcProblem problemOf(const std::string& path, const polyfly::MapSet& set, std::size_t axis,
                              const polyfly::MpcProblem& made) {
  if (!path.empty()) return polyfly::loadProblem(path);
  return set.empty() || set.problems.at(axis).minimum_peak ? made : set.problems.at(axis);
}

}  // namespace

const polyfly::MapSet& LawSources::explicitMaps() const {
  return mapsOf(polyfly::lawOfName("explicit_linear"));
}

std::shared_ptr<const LawSources> LawSources::load(const LawFiles& files,
                                                   const polyfly::MultirotorModel& model,
                                                   const polyfly::MultirotorOptions& options) {
  auto sources = std::make_shared<LawSources>();
  sources->maps = polyfly::openMaps(polyfly::lawTypes(), files.maps, options);
  const std::array<polyfly::MpcProblem, 3> made = polyfly::linearProblems(model, kSamplingTime, kHorizon);
  for (std::size_t i = 0; i < 3; ++i) {
    sources->problems[i] = problemOf(files.problems[i], sources->explicitMaps(), i, made[i]);
  }
  return sources;
}

}  // namespace polyfly_ros
